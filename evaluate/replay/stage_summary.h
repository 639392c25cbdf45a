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

/// The batches of both stages. `kept` is the guide's own batch; the full one starts from it.
StageBatches<CameraStageResult> cameraBatches(const ReplayRun& run,
                                              const Result<CameraStageResult>& kept);
/// `cameras`: those the stage ran with.
StageBatches<CameraImuStageResult> cameraImuBatches(const ReplayRun& run,
                                                    const std::vector<CameraCalibration>& cameras,
                                                    const Result<CameraImuStageResult>& kept);

/// A stage in figures. Redundant and missed views (camera stage) are those of viewHindsight() at
/// the kept batch's cameras; the information after "finish" of the camera-IMU stage is the
/// difference of the two batches' entropies.
ReplayStageSummary summariseCameraStage(const ReplayRun& run,
                                        const StageBatches<CameraStageResult>& batches);
ReplayStageSummary summariseCameraImuStage(const ReplayRun& run,
                                           const StageBatches<CameraImuStageResult>& batches);

}  // namespace plumbline
