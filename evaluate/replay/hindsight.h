// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/session.h"
#include "calibrator/base/transform.h"
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

/// What became of each suggestion of the guide: read off its decisions, with the corners that
/// `cameras` would see at it.
std::vector<SuggestionOutcome> suggestionOutcomes(const ReplayRun& run,
                                                  const std::vector<CameraCalibration>& cameras);

/// How the operator of a guided recording followed the suggestions that were shown to him: each is
/// open from its time until the next one, and reached by the guide's own rule of its stage, in the
/// camera that it was made for; one that is not has expired after the guide's limit, or was
/// withdrawn for the next one before; the last has no event where the frames end before that.
/// Those shown before the first frame or after the
/// last are left out. Distances of poses need the poses of the frames: those of `full`.
OperatorCompliance operatorCompliance(const ReplayRun& run,
                                      const std::vector<Suggestion>& suggestions,
                                      const std::vector<CameraCalibration>& cameras);

/// Where a file of suggestions comes from: an option, or beside the recording.
enum class SuggestionsFile { kGiven, kFound };

/// Throws InputError where none of the file's suggestions was shown within a minute of a frame of a
/// whole recording: they are another recording's, or of another clock. A frame without another one
/// so near does not count, for its stamp may be wrong.
void checkShownWithin(const std::vector<GuideFrame>& frames,
                      const std::vector<Suggestion>& suggestions, const std::string& path,
                      SuggestionsFile file);

/// The compliance in a recording that is not replayed; its suggestions are those that it has beside
/// it.
OperatorCompliance operatorCompliance(const Session& session,
                                      const std::vector<Suggestion>& suggestions,
                                      const std::vector<CameraCalibration>& cameras);

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
