// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/window/linear_prior.h"

#include <cassert>

namespace plumbline {

QuadraticCost LinearPrior::at(const Eigen::VectorXd& d) const {
  assert(d.size() == size());
  const Eigen::VectorXd Hd = cost_.H * d;
  return {cost_.H, cost_.b + Hd, cost_.c + d.dot(cost_.b) + 0.5 * d.dot(Hd)};
}

}  // namespace plumbline
