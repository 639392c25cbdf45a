// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/guide_decision.h"
#include "calibrator/base/results.h"
#include "calibrator/guidance/guide_options.h"

namespace plumbline {

/// The camera stage of the Guide: next best view of the paper.
///
/// Start: a batch over the first frames that moved against each other; where it fails (too few
/// views, not observable), again with more, and the decision says why it failed. A start under
/// which the frames that follow have no plausible pose is given up, its frames withdrawn, and the
/// stage restarts; so is one that leaves 1.25 times the RMSE, on the frames after it, of an
/// estimate made from those alone (10, 20 and 40 that moved against each other). From then on each
/// frame gets a pose from its own corners and the cameras as they are, and is scored against the
/// information of all views kept (fixed-lag window and its prior, CameraWindow): below the
/// threshold it is left out before it takes part, otherwise the window is solved with it.
///
/// Suggestions: with the first frame one of firstViews(), not scored, and drawn anew by the
/// estimate once it stands. From then on, whenever none is open, candidateViews() are scored: the
/// best on whose way the target stays in view is suggested, or the stage finishes where even the
/// best gains less than the threshold. With `patience` above 0 there is no suggestion before the
/// start, and later ones wait for so many frames without a new view. While a suggestion is open
/// informative frames are taken as before; a new one is looked for once it is reached or has
/// expired.
///
/// Every frame gets a Decision. Those without target, without plausible pose, or with a stamp that
/// is not after the one before or far after it change nothing but the suggestion's clock; pauses
/// and a target that is long out of view are said in `detail`. Decisions depend on frames and
/// options alone, not on `threads`. Throws InputError for a model that cannot be calibrated or an
/// image without size.
class CameraGuide {
 public:
  /// Suggestions are numbered from `first_suggestion`.
  CameraGuide(const GuideRig& rig, const GuideOptions& options, int first_suggestion = 0);
  ~CameraGuide();
  CameraGuide(CameraGuide&&) noexcept;

  Decision step(const GuideFrame& frame);
  bool finished() const;
  /// Until when the guide is busy with what it was given last, latencies included.
  TimeNs busyUntil() const;
  /// When its time began (FrameGate::since()); empty before the first frame.
  std::optional<TimeNs> since() const;
  int nextSuggestion() const;
  /// Batch over the frames kept so far, from the estimate as it stands; from nothing before the
  /// start stands. Fails as calibrateCameras() does.
  Result<CameraStageResult> batch() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// What the stage before leaves to the next.
struct StageBegin {
  int first_suggestion = 0;  ///< suggestions are numbered from it
  /// Frames before it are dropped (their IMU samples are not).
  TimeNs busy_until = std::numeric_limits<TimeNs>::min();
  /// Stamp of the last frame of the stage before.
  std::optional<TimeNs> last_frame = std::nullopt;
};

/// The camera-IMU stage of the Guide: next best trajectory of the paper. The cameras stay as they
/// are given.
class CameraImuGuide {
 public:
  /// Needs rig.imu. Throws InputError for options out of range.
  CameraImuGuide(const GuideRig& rig, std::vector<CameraCalibration> cameras,
                 const GuideOptions& options, const StageBegin& begin = {});
  ~CameraImuGuide();
  CameraImuGuide(CameraImuGuide&&) noexcept;

  Decision step(const GuideFrame& frame);
  bool finished() const;
  TimeNs busyUntil() const;
  /// As of CameraGuide.
  std::optional<TimeNs> since() const;
  int nextSuggestion() const;
  /// Batch over the frames kept so far, time offset included.
  Result<CameraImuStageResult> batch() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The paper's interactive guide as a state machine over frames, driven by whoever has them.
///
/// First the camera stage (next best view), unless `cameras` are given; when it finishes, or its
/// time is over, its views are solved in batch, and the camera-IMU stage (next best trajectory)
/// begins with the frames that follow. Time is that of the frames: equal frames and options give
/// equal decisions, whatever the threads and the speed at which step() is called.
class Guide {
 public:
  Guide(const GuideRig& rig, const GuideOptions& options,
        std::optional<std::vector<CameraCalibration>> cameras = std::nullopt);

  /// Frames in the order in which they arrive.
  Decision step(const GuideFrame& frame);

  /// Nothing is left to ask for.
  bool finished() const;
  /// The camera stage was ended by GuideOptions::camera_stage_s, and did not say stop itself.
  bool cameraStageEnded() const { return camera_ended_; }
  /// When the first stage's time began (FrameGate::since()); empty before its first frame, or
  /// without a stage.
  std::optional<TimeNs> since() const;

  /// The final batch of a stage over the frames that it kept: what the operator is given. Before
  /// the stage finishes: over those kept so far.
  Result<CameraStageResult> cameraBatch() const;

 private:
  bool cameraOver() const { return camera_ended_ || camera_->finished(); }
  Decision stepCamera(const GuideFrame& frame);
  void endByTime(Decision& last);
  void endCameraStage(Decision& last);

  GuideRig rig_;
  GuideOptions options_;
  std::optional<CameraGuide> camera_;                      // unless cameras were given
  std::optional<Result<CameraStageResult>> camera_batch_;  // once the camera stage is over
  std::optional<CameraImuGuide> camera_imu_;               // while and after it runs
  bool camera_ended_ = false;                              // by GuideOptions::camera_stage_s
  bool never_shown_ = false;                               // what its last frame opened
};

}  // namespace plumbline
