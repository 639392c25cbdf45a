// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/transform.h"
#include "evaluate/replay/stage_summary.h"

namespace plumbline {

/// When views count as enough, and when a stop as late.
struct StoppingRuleOptions {
  /// Camera stage: held-out RMSE within this factor of the one of the batch over all frames.
  double held_out_factor = 1.1;
  int held_out_frames = 200;  ///< at most; evenly spread over the frames that were not kept
  /// Camera-IMU stage: T_SC0 and time offset this close to those of the batch over all frames.
  double translation_m = 1e-3;
  double rotation_rad = 0.05 * kDegree;
  double offset_s = 1e-4;
  int checkpoints = 12;    ///< how many batches the search for "enough" may cost
  double tolerance_s = 5;  ///< a stop this much after "enough" is still right

  /// Throws InputError for values out of range.
  void check() const;
};

/// Camera stage: the views kept, and after "finish" those that would have been kept by the same
/// threshold, are solved in batch for a growing number of them, and scored on frames that were not
/// kept (only poses move). They are enough from the first number on from which the error stays
/// within options.held_out_factor of that of all frames' batch. Throws InputError for options out
/// of range.
StopAudit judgeCameraStop(const ReplayRun& run, const StageBatches<CameraStageResult>& batches,
                          const StoppingRuleOptions& options = {});

/// Camera-IMU stage: the same for the frames since the stage's start, held against T_SC0 and time
/// offset of the batch over all of them; of a stage that stops by
/// TrajectoryGuideOptions::stop_reprojection_px, by the points that the IMU predicts, which that
/// bar is for. Throws InputError for options out of range.
StopAudit judgeCameraImuStop(const ReplayRun& run, const std::vector<CameraCalibration>& cameras,
                             const StageBatches<CameraImuStageResult>& batches,
                             const StoppingRuleOptions& options = {});

}  // namespace plumbline
