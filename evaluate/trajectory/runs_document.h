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

/// trajectory.json of a study: provenance, summary, pairedDifferences(), and the runs, each as
/// trajectoryRunJson with its sequence, calibration, run, status and problem.
std::string runsDocument(const TrajectoryRecord& record);

/// trajectory.csv: one row for each run.
std::string runsTable(const TrajectoryRecord& record);

/// "complete", "partial", "failed".
const char* nameOf(RunStatus status);

}  // namespace plumbline
