// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

namespace plumbline {

/// A variance that was estimated from data: dof value / truth is a chi-square deviate with `dof`
/// degrees of freedom.
struct EstimatedVariance {
  double value = 0;
  double dof = std::numeric_limits<double>::infinity();  ///< infinite: the variance is known
};

/// Of the sum of two independent quantities (Welch 1947; Satterthwaite 1946):
///   v = v_1 + v_2,   dof = v^2 / (v_1^2 / dof_1 + v_2^2 / dof_2).
EstimatedVariance sumOf(const EstimatedVariance& a, const EstimatedVariance& b);

/// Standard deviations beside the degrees of freedom of the variances that they are roots of.
struct RobustDeviations {
  Eigen::VectorXd std, dof;
};

/// Half width of the 90 % interval about an estimate, in the unit of its deviation:
///   std t,   t the quantile 0.95 of Student's t with `dof` degrees of freedom,
/// of the normal distribution (1.645) where dof is infinite. NaN where either is, or dof is not
/// above 0.
double halfWidth90(double std, double dof);

/// Of every deviation; empty where there are none or their degrees of freedom are not known.
std::optional<Eigen::VectorXd> halfWidths90(const std::optional<Eigen::VectorXd>& std,
                                            const std::optional<Eigen::VectorXd>& dof);

}  // namespace plumbline
