// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

namespace plumbline {

/// Wilcoxon's signed rank test of differences that are symmetric about their centre.
struct SignedRank {
  double statistic = 0;       ///< V: sum of the ranks of positive differences
  double p = 1;               ///< two-sided and exact: every sign of the (mid)ranks that occurred
  double hodges_lehmann = 0;  ///< median of the Walsh averages (x_i + x_j) / 2, i <= j
  std::optional<double> low, high;  ///< of the centre; empty where n is too small for any
};

/// Differences of zero carry no sign and are left out of the test (Wilcoxon), not of the estimate.
/// Ties have the mean of their ranks, and the distribution is that of these ranks. The interval's
/// ends are order statistics of the Walsh averages by the distribution without ties. Not empty.
SignedRank signedRank(const std::vector<double>& differences, double confidence = 0.95);

/// Ranks from 1 on, ties with the mean of theirs.
std::vector<double> midranks(const std::vector<double>& values);

}  // namespace plumbline
