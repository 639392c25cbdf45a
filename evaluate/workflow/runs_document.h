// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/records/trajectory_record.h"

namespace plumbline {

/// A calibration over all runs of one sequence, or of all ("").
struct RunsSummary {
  std::string sequence, calibration;
  std::size_t expected = 0, complete = 0, partial = 0, failed = 0;
  double completion = 0;  ///< complete / expected
  /// Median over the expected runs of the ATE (RMSE of positions [m]), where one that is not
  /// complete counts as larger than any; empty where the median is such a one.
  std::optional<double> ate_median_m;
};

/// By sequence, then, of several, all together; calibrations in the order of the runs.
std::vector<RunsSummary> summarised(const std::vector<TrajectoryRun>& runs);

/// Two calibrations over the (sequence, run) that both completed: d = ATE of b - ATE of a.
struct RunsDifference {
  std::string a, b;
  std::size_t pairs = 0;
  std::size_t left_out = 0;  ///< of the expected, not complete under both
  double mean_m = 0, median_m = 0;
  double std_m = 0;          ///< of d, divisor n
  std::size_t b_better = 0;  ///< d < 0
};

std::vector<RunsDifference> differences(const std::vector<TrajectoryRun>& runs);

/// trajectory.json of many runs: provenance, summary, paired differences, and the runs, each as
/// trajectoryRunJson with its sequence, calibration, run, status and problem.
std::string runsDocument(const TrajectoryRecord& record);

/// trajectory.csv: one row for each run.
std::string runsTable(const TrajectoryRecord& record);

/// "complete", "partial", "failed".
const char* nameOf(RunStatus status);

}  // namespace plumbline
