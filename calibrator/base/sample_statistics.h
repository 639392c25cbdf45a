// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace plumbline {

/// Percents at which SampleStatistics keeps percentiles.
inline constexpr std::array<double, 6> kPercents = {1, 5, 25, 75, 95, 99};

/// What is said of a set of scalar errors x_i, i = 1..n, in their own unit.
struct SampleStatistics {
  double rmse = 0;    ///< sqrt(sse / n)
  double mean = 0;    ///< sum x / n
  double median = 0;  ///< mean of the middle two where n is even
  double std = 0;     ///< sqrt(sum (x - mean)^2 / (n - ddof))
  double min = 0;
  double max = 0;
  double sse = 0;                                      ///< sum x^2
  std::array<double, kPercents.size()> percentiles{};  ///< at kPercents, linear interpolation
  std::size_t n = 0;
};

/// Statistics of `values`; all zero for none. `ddof` 0 divides the variance by n (evo, rpg), 1 by
/// n - 1 (ov_eval; 0 there for a single value).
SampleStatistics sampleStatistics(std::vector<double> values, int ddof = 0);

}  // namespace plumbline
