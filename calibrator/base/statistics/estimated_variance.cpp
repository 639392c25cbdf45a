// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

#include "calibrator/base/statistics/statistics.h"

namespace plumbline {

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

std::optional<Eigen::VectorXd> halfWidths90(const std::optional<Eigen::VectorXd>& std,
                                            const std::optional<Eigen::VectorXd>& dof) {
  if (!std || !dof || std->size() != dof->size()) return std::nullopt;
  return std->binaryExpr(*dof, &halfWidth90);
}

}  // namespace plumbline
