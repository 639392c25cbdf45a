// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/statistics/statistics.h"

namespace plumbline {

/// Half the 95 % interval about an estimate, in the unit of its deviation: `std` times quantile
/// 0.975 of Student's t with `dof` degrees of freedom, of the normal distribution (1.96) where dof
/// is infinite. NaN where `std` is, or dof is not above 0.
double halfWidth95(double std, double dof);

/// A difference in standard deviations: the normal deviate z >= 0 that is exceeded as rarely as
/// Student's t by this one,
///   P(|N| > z) = P(|T_dof| > |t|),   t = difference / sqrt(variance),
/// for a variance from few degrees of freedom is uncertain itself; |t| where dof is infinite,
/// otherwise 37.5 at most. NaN where t is, or dof is not above 0.
double normalDeviate(double difference, const EstimatedVariance& variance);

/// std / sqrt(n) of n independent values, the standard error of their mean: with n - 1 degrees of
/// freedom. NaN for fewer than two.
double standardError(const std::vector<double>& values);

}  // namespace plumbline
