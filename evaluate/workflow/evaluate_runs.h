// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "evaluate/workflow/evaluate_trajectory.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

/// Runs x sequences x calibrations against their truths.
struct RunsRequest {
  std::string runs;           ///< pattern of the estimates, see findRuns
  std::string truth;          ///< pattern with {sequence} at most
  TrajectoryRequest how;      ///< but for the files: how each is read and judged
  double min_coverage = 0.9;  ///< of the truth's span; a run below is partial
  /// ATE (RMSE of positions [m]) above which a run has diverged. Unset: the RMS distance of the
  /// truth's positions from their mean, which an estimate that never moves would reach.
  std::optional<double> max_ate_m;
  int threads = 0;  ///< 0: all cores
};

/// One run for each calibration with each (sequence, run) that any calibration has, sorted by
/// sequence, calibration, run. What is missing, cannot be read, has no truth, cannot be paired or
/// aligned, or has diverged, is failed; what covers too little is partial; each says why. Nothing
/// is left out. The result does not depend on threads or on the order of files. name and provenance
/// are the caller's. Throws InputError where no estimate is found, or a truth cannot be read.
TrajectoryRecord evaluateRuns(const RunsRequest& request);

}  // namespace plumbline
