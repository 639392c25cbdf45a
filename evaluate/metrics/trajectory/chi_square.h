// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace plumbline {

/// The value that a chi-square variable of `dof` degrees of freedom stays below with probability
/// `p`. By bisection of the regularised incomplete gamma function up to 200 degrees (to 1e-9
/// relative), beyond by Wilson and Hilferty (to 1e-4). dof > 0, 0 < p < 1; the extremes 1e-6 and
/// 1 - 1e-6 are the furthest that are asked for.
double chiSquareQuantile(double dof, double p);

}  // namespace plumbline
