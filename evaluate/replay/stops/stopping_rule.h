// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/transform.h"
#include "evaluate/replay/stage_summary.h"

namespace plumbline {

/// When views count as sufficient, and when a stop as late. Errors are those to be expected against
/// the truth (Distance::expectedError()): the distance from the calibration of all frames, and its
/// own standard deviation, in the camera-IMU stage under the cameras that both use.
struct StoppingRuleOptions {
  /// Camera stage: held-out RMSE within this factor of the one of the batch over all frames.
  double held_out_factor = 1.1;
  int held_out_frames = 200;  ///< at most; evenly spread over the frames that were not kept
  /// Camera stage: error of the worst camera's projections, RMS over the image [px]. Poses absorb
  /// most of such an error, so that held-out frames hardly show it. 0: what raises the full batch's
  /// error e of a corner by held_out_factor as well, were it not absorbed,
  /// e sqrt(held_out_factor^2 - 1).
  double projection_px = 0;
  /// Errors of T_C0Ci (camera stage), of T_SC0 and of the time offset (camera-IMU stage).
  double translation_m = 1e-3;
  double rotation_rad = 0.05 * kDegree;
  double offset_s = 1e-4;
  int checkpoints = 12;    ///< how many batches the search for "enough" may cost
  double tolerance_s = 5;  ///< a stop this much after "enough" is still right

  /// Throws InputError for values out of range.
  void check() const;
};

/// Camera stage: the views kept, and after "finish" those that would have been kept by the same
/// threshold, are solved in batch for a growing number of them. They are sufficient from the first
/// number on from which all three stay within options: the error on frames that were not kept (only
/// poses move), and those of projections and T_C0Ci. Of a stage that stops by
/// ViewGuideOptions::stop_projection_px the projections' error alone, against that bar. Throws
/// InputError for options out of range.
StopAudit judgeCameraStop(const ReplayRun& run, const StageBatches<CameraStageResult>& batches,
                          const StoppingRuleOptions& options = {});

/// Camera-IMU stage: the same for the frames since the stage's start, by the errors of T_SC0 and
/// time offset; of a stage that stops by TrajectoryGuideOptions::stop_reprojection_px, by that of
/// the points that the IMU predicts, against that bar. Throws InputError for options out of range.
StopAudit judgeCameraImuStop(const ReplayRun& run, const std::vector<CameraCalibration>& cameras,
                             const StageBatches<CameraImuStageResult>& batches,
                             const StoppingRuleOptions& options = {});

}  // namespace plumbline
