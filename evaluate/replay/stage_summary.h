// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera/batch.h"
#include "evaluate/replay/frames.h"
#include "report/records/replay_record.h"

namespace plumbline {

/// What each frame of a session tells of its cameras, all at one estimate, so that they add up.
struct FrameShares {
  std::vector<Frame> frames;                 ///< those with a pose, ascending in time
  std::vector<Eigen::MatrixXd> information;  ///< one per frame, its own pose eliminated
};

/// At given cameras; only poses are estimated (scoreCameras()). Rows: all intrinsics, then all
/// T_C0Ci. Fails where scoreCameras() does.
Result<FrameShares> frameShares(const Session& session,
                                const std::vector<CameraCalibration>& cameras,
                                const CameraStageOptions& options);

/// How a frame of the recording was used.
enum class FrameUse { kKept, kPassedBy, kAfterFinish };

/// What the choice of views looks like once everything is known.
struct ViewHindsight {
  /// Kept frames that gain less than the threshold beside the other ones: taken away one after the
  /// other in recorded order, each only if the rest still holds its information.
  int redundant = 0;
  /// Frames passed by that gain the threshold or more beside the kept ones: added one after the
  /// other in recorded order.
  int missed = 0;
  /// What all frames after "finish" would have added to the kept ones [nats].
  double after_finish_nats = 0;
};

/// `shares` as in FrameShares, one per frame in recorded order, with `uses`. Where the kept frames
/// do not determine the cameras nothing is redundant or missed, and after_finish_nats is infinite
/// if the rest determines them.
ViewHindsight viewHindsight(const std::vector<Eigen::MatrixXd>& shares,
                            const std::vector<FrameUse>& uses, double threshold_nats);

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
