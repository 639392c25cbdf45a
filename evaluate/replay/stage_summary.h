// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "calibrator/base/error.h"
#include "evaluate/replay/replay_inputs.h"
#include "report/records/replay_record.h"

namespace plumbline {

/// What the batches of a stage gave: over the frames it kept, and over all frames of the recording
/// (camera-IMU: from the stage's first frame on).
template <class StageResult>
struct StageBatches {
  std::optional<StageResult> kept;
  std::optional<StageResult> full;
  std::string problem;  ///< why one of them is missing
};

/// The batches of the camera stage, both under run.camera, so that they differ by their frames
/// alone. That over the kept frames starts from the guide's own batch where there is one, the full
/// one from that.
StageBatches<CameraStageResult> cameraBatches(const ReplayRun& run,
                                              const Result<CameraStageResult>& guides_own);
/// Those of the camera-IMU stage, both under run.camera_imu. `cameras` are those the stage ran
/// with. Nothing where the stage was not entered.
StageBatches<CameraImuStageResult> cameraImuBatches(const ReplayRun& run,
                                                    const std::vector<CameraCalibration>& cameras);

/// A stage in figures. Redundant and missed views (camera stage) are those of viewHindsight() at
/// the kept batch's cameras; the information after "finish" of the camera-IMU stage is the
/// difference of the two batches' entropies.
ReplayStageSummary summariseCameraStage(const ReplayRun& run,
                                        const StageBatches<CameraStageResult>& batches);
ReplayStageSummary summariseCameraImuStage(const ReplayRun& run,
                                           const StageBatches<CameraImuStageResult>& batches);

}  // namespace plumbline
