// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstddef>

#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

#include "calibrator/base/statistics/statistics.h"

namespace plumbline {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

EstimatedVariance sumOf(const EstimatedVariance& a, const EstimatedVariance& b) {
  const double v = a.value + b.value;
  if (v == 0) return {};  // it is known that neither varies
  return {v, v * v / (a.value * a.value / a.dof + b.value * b.value / b.dof)};
}

double halfWidth90(double std, double dof) {
  // Said here, for the quantile of no degrees of freedom would throw.
  if (std::isnan(std) || !(dof > 0)) return std::numeric_limits<double>::quiet_NaN();
  // Two-sided: 5 % are left at either end.
  constexpr double kUpper = 0.95;
  return std * (std::isinf(dof) ? boost::math::quantile(boost::math::normal(), kUpper)
                                : boost::math::quantile(boost::math::students_t(dof), kUpper));
}

std::optional<VectorXd> halfWidths90(const std::optional<VectorXd>& std,
                                     const std::optional<VectorXd>& dof) {
  if (!std || !dof || std->size() != dof->size()) return std::nullopt;
  return std->binaryExpr(*dof, &halfWidth90);
}

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
