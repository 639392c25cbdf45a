// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "evaluate/odometry/builtin_run.h"
#include "evaluate/odometry/calibration_hint.h"
#include "evaluate/odometry/runner.h"
#include "evaluate/results/progress.h"
#include "evaluate/trajectory/evaluate_runs.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

/// Every calibration on every sequence, `runs` times.
struct OdometryRequest {
  std::vector<std::string> sequences;     ///< folders
  std::vector<std::string> calibrations;  ///< files; named after the file, or the folder of a
                                          ///< calibration.json
  std::optional<std::string> imu;         ///< noise of the IMU, in place of what they state
  std::optional<Runner> runner;           ///< empty: the built-in odometry
  std::string executable;                 ///< in place of the runner's
  int runs = 0;                           ///< 0: 1, or what the runner needs at least
  std::optional<std::string> truth;       ///< file, or a pattern with {sequence}; empty: found
                                          ///< beside the sensors
  bool sensitivity = false;               ///< also move every parameter by itself (sensitivity.h)
  HintKind hint = HintKind::kNone;        ///< what the odometry itself would choose, too
  BuiltinOptions builtin;
  double run_seconds = 3600;     ///< wall time of another system's run
  std::size_t memory_bytes = 0;  ///< and its address space; 0: no limit
  TrajectoryRequest how;         ///< but for the files: how the estimates are judged
  double min_coverage = kLeastCoverage;
  std::optional<double> max_ate_m;
  int threads = 0;  ///< runs at once; 0: all cores

  /// Throws InputError for values out of range.
  void check() const;
};

/// Runs them, writes OUT/runs/{calibration}/{sequence}_{run}.txt (TUM, body = IMU, camera clock)
/// and judges each against its truth as evaluateRuns() does. A run that ended without a trajectory,
/// was lost on its way, or diverged is failed, with its reason and the log's last lines; none is
/// left out. Runs of the built-in odometry are equal, so it runs once. What the built-in one makes
/// does not depend on threads. A sequence without truth is run, too; its runs have no errors, and
/// what needs no truth. Throws InputError for sequences, calibrations and truths that cannot
/// be read, for a calibration of another rig, and where two calibrations have one name.
TrajectoryRecord runOdometry(const OdometryRequest& request, const std::filesystem::path& out,
                             const ProgressSink& progress);

/// What `odometry` prints for a person, besides runsSummary(): how long the runs took, and what of
/// them was lost or skipped.
std::string odometrySummary(const TrajectoryRecord& record);

}  // namespace plumbline
