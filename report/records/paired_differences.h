// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "report/records/trajectory_record.h"

namespace plumbline {

/// Two calibrations over the same sequences and runs: d = ATE under b - ATE under a, where ATE is
/// the RMSE of the positions [m]. Negative: b is better.
struct PairedDifference {
  std::string a, b;
  std::size_t pairs = 0;     ///< complete under both
  std::size_t left_out = 0;  ///< (sequence, run) under either that is not complete under both
  double mean_m = 0;
  double median_m = 0;
  double std_m = 0;          ///< of d, divisor n
  std::size_t b_better = 0;  ///< pairs with d < 0
  std::size_t ties = 0;      ///< d = 0; the sign test leaves them out
  double sign_test_p = 1;    ///< two-sided, exact (binomial)
  /// 95 % interval of the mean: percentile bootstrap over pairs, 10,000 resamples, fixed seed.
  /// Empty below five pairs, where it would say nothing.
  std::optional<double> low_m, high_m;
};

/// Every two calibrations of the runs, in order of appearance. Runs that failed or are partial have
/// no comparable error; their pairs are counted as left out. Runs pair by sequence and run.
std::vector<PairedDifference> pairedDifferences(const std::vector<TrajectoryRun>& runs);

/// Exact two-sided p of `successes` out of n fair coin tosses; 1 for n = 0.
double signTest(std::size_t successes, std::size_t n);

}  // namespace plumbline
