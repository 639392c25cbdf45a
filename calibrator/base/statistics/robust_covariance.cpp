// SPDX-License-Identifier: BSD-3-Clause
#include <cstddef>

#include "calibrator/base/statistics/statistics.h"

namespace plumbline {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double ClusterDegrees::of(const VectorXd& combination) const {
  const auto blocks = static_cast<Index>(adjustment.size());
  MatrixXd a(combination.size(), blocks), Ga(combination.size(), blocks);
  for (Index b = 0; b < blocks; ++b) {
    const auto at = static_cast<std::size_t>(b);
    a.col(b) = adjustment[at] * combination;
    Ga.col(b) = leverage[at] * a.col(b);
  }
  // W_bc = [b = c] a_b' G_b a_b - a_b' G_b G_c a_c.
  MatrixXd W = -(Ga.transpose() * Ga);
  W.diagonal() += a.cwiseProduct(Ga).colwise().sum();
  // W is symmetric: tr(W^2) is the sum of the squares of its entries.
  const double trace = W.trace();
  return trace * trace / W.squaredNorm();
}

EstimatedVariance RobustCovariance::variance(const VectorXd& combination) const {
  const auto along = [&](const MatrixXd& C) { return combination.dot(C * combination); };
  const double certain = known.size() > 0 ? along(known) : 0;
  // The known part has infinitely many degrees of freedom.
  return sumOf({along(matrix) - certain, degrees.of(combination)}, {certain});
}

RobustDeviations RobustCovariance::deviations(Index count) const {
  RobustDeviations out{matrix.diagonal().head(count).cwiseSqrt(), VectorXd(count)};
  for (Index k = 0; k < count; ++k) {
    out.dof(k) = variance(VectorXd::Unit(matrix.rows(), k)).dof;
  }
  return out;
}

}  // namespace plumbline
