// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/calibration.h"

#include <cassert>

namespace plumbline {
Eigen::VectorXd Intrinsics::stacked() const {
  Eigen::VectorXd all(projection.size() + distortion.size());
  all << projection, distortion;
  return all;
}

void Intrinsics::setStacked(const Eigen::VectorXd& parameters) {
  assert(parameters.size() == projection.size() + distortion.size());
  projection = parameters.head(projection.size()).eval();
  distortion = parameters.tail(distortion.size()).eval();
}

}  // namespace plumbline
