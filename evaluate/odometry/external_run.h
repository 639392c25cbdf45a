// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/transform.h"
#include "evaluate/odometry/runner.h"
#include "evaluate/odometry/sequence.h"

namespace plumbline {

/// One run of another odometry.
struct ExternalRequest {
  Runner runner;
  std::string executable;             ///< in place of the runner's; empty: that one, by PATH
  std::filesystem::path calibration;  ///< its file
  bool noise_known = true;            ///< whether the calibration states the IMU's noise
  int run = 1;
  bool refine = false;           ///< with its online calibration (Runner::online)
  double seconds = 3600;         ///< limit of wall time
  std::size_t memory_bytes = 0;  ///< limit of address space; 0: none
};

/// What it left. Empty `problem`: a trajectory.
struct ExternalRun {
  std::vector<StampedPose> poses;  ///< body = IMU, camera clock
  double seconds = 0;
  std::string problem;           ///< how it failed, "" if not
  std::vector<std::string> log;  ///< last lines of what it printed, of a run that failed
  /// What its online calibration printed, in order; empty unless asked for.
  std::vector<double> offsets_s;
  std::vector<Transform> T_SC0;
};

/// Runs another odometry on a sequence in `folder`, which is there and empty: writes its settings,
/// links to the sequence's images with an IMU that is shifted where it knows no time offset, and
/// reads what it wrote. Every end but a readable trajectory is a problem, not an exception; throws
/// InputError where its settings cannot be exported.
ExternalRun runExternal(const ExternalRequest& request, const OdometrySequence& sequence,
                        const Calibration& calibration, const std::filesystem::path& folder);

}  // namespace plumbline
