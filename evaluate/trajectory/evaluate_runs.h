// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "evaluate/trajectory/evaluate_trajectory.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

/// Share of the truth's span below which a run is partial, unless told otherwise.
inline constexpr double kLeastCoverage = 0.9;

/// Runs x sequences x calibrations against their truths.
struct RunsRequest {
  std::string runs;                      ///< pattern of the estimates, see findRuns
  std::string truth;                     ///< pattern with {sequence} at most
  TrajectoryRequest how;                 ///< but for the files: how each is read and judged
  double min_coverage = kLeastCoverage;  ///< of TrajectoryMetricOptions::coverage's span; a run
                                         ///< below is partial
  /// ATE (RMSE of positions [m]) above which a run has diverged. Unset: the RMS distance of the
  /// truth's positions from their mean, which an estimate that never moves would reach; half of it
  /// under sim3, whose scale may shrink an estimate to a point.
  std::optional<double> max_ate_m;
  /// The only words that {calibration} may stand for, each with runs or without; empty: any.
  std::vector<std::string> calibrations;
  int threads = 0;  ///< 0: all cores

  /// Throws InputError for values out of range.
  void check() const;
};

/// One run for each calibration with each (sequence, run) that any calibration has, sorted by
/// sequence, calibration, run. What is missing, cannot be read, has no truth, cannot be paired or
/// aligned, or has diverged, is failed; what covers too little is partial; each says why. Nothing
/// is left out. The result does not depend on threads or on the order of files. name and provenance
/// are the caller's. Throws InputError where no estimate is found, a truth cannot be read, or a
/// calibration is none of `calibrations`.
TrajectoryRecord evaluateRuns(const RunsRequest& request);

/// One of them: the file `expected.estimate` against a truth that is at hand, or a part of it. Its
/// sequence, calibration and run are kept; `request` says how it is judged, not which files.
TrajectoryRun judgedRun(const TrajectoryRun& expected, const std::filesystem::path& truth_path,
                        const TrajectoryFile& truth, const RunsRequest& request);

/// A study of one run, so that it can be kept and shown as many are: partial, with its errors,
/// where it diverged or is below the least coverage, as `request` has the limits. `run` and
/// `sequence` are named after the files of estimate and truth, or after the folder of the recording
/// where a file lies in one ("MH_01/mav0/vicon0/data.csv": "MH_01").
TrajectoryRecord studyOfOne(TrajectoryRun run, const RunsRequest& request);

/// "covers 89.96 % of the truth's time, less than 90 %": a share below `least`, with as many digits
/// as it takes to show that.
std::string coverageText(double share, double least, const char* of_what);

}  // namespace plumbline
