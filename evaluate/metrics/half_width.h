// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace plumbline {

/// Half the 95 % interval about an estimate, in the unit of its deviation: `std` times quantile
/// 0.975 of Student's t with `dof` degrees of freedom, of the normal distribution (1.96) where dof
/// is infinite. NaN where `std` is, or dof is not above 0.
double halfWidth95(double std, double dof);

/// std / sqrt(n) of n independent values, the standard error of their mean: with n - 1 degrees of
/// freedom. NaN for fewer than two.
double standardError(const std::vector<double>& values);

}  // namespace plumbline
