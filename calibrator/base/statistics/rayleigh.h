// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace plumbline {

/// Median of |e| over sigma where both axes of e have white noise of standard deviation sigma: that
/// of the Rayleigh distribution, sqrt(2 ln 2).
inline constexpr double kRayleighMedian = 1.1774100225154747;

}  // namespace plumbline
