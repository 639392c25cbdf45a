// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "calibrator/base/frames.h"
#include "calibrator/base/guide_decision.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/guidance/guide_options.h"

namespace plumbline {

struct GuideFramesOptions {
  TimeNs tolerance = FrameOptions().tolerance;  ///< of stamps within a frame [ns]
  /// How long after its stamp an image is there [s]: exposure, transfer, detection. IMU samples
  /// stamped until then arrive with it.
  double arrival_s = 0.05;

  void check() const;  ///< throws InputError naming the field that is out of its range
};

/// A recording's frames, those without corners as well: one for each that guideFrames() gives.
std::vector<Frame> pairedFrames(const Session& session, const GuideFramesOptions& options = {});

/// A recording as the guide would have got it: every frame, also those in which no target was
/// found, with the IMU samples that arrived since the frame before. The first frame brings those of
/// the second before it.
std::vector<GuideFrame> guideFrames(const Session& session, const GuideFramesOptions& options = {});

/// What a session tells of its sensor. `models` one per camera; empty: the session's own words,
/// pinhole-radtan where it has none (see CameraStageOptions).
GuideRig guideRig(const Session& session, const std::vector<CameraModelPair>& models = {});

/// How a camera stage ended.
enum class CameraStageEnd {
  kItself,  ///< by its stop, or with the recording
  kTime,    ///< GuideOptions::camera_stage_s
  kHalf,    ///< likewise, at half of the recording, in the whole of which it does not say stop
};

/// A replay that has run, for those who judge it. All members outlive the judging.
struct ReplayRun {
  const Session& session;
  const std::vector<GuideFrame>& frames;
  const std::vector<Decision>& decisions;  ///< one per frame
  GuideOptions guide;
  /// Of the batches; without a tolerance of stamps, since a frame's views have one stamp here.
  CameraStageOptions camera;
  CameraImuOptions camera_imu;  ///< likewise
  CameraStageEnd camera_end = CameraStageEnd::kItself;
  std::optional<TimeNs> since = std::nullopt;  ///< Guide::since()

  /// Where times into the recording count from.
  TimeNs begin() const { return since.value_or(frames.front().t); }
  /// Positions of the frames that a stage accepted and did not withdraw later, ascending.
  std::vector<int> accepted(GuideStage stage) const;
  /// The decision with which a stage finished, or was ended; null if it went on.
  const Decision* finish(GuideStage stage) const;
  bool wasEnded(GuideStage stage) const {
    return stage == GuideStage::kCamera && camera_end != CameraStageEnd::kItself;
  }
  /// The session of some of the frames (ascending positions as GuideFrame::index has them), with
  /// all IMU samples; all views of a frame carry the frame's stamp.
  Session sessionOfFrames(const std::vector<int>& wanted) const;
  /// The same of all frames, or of those from position `first` on.
  Session sessionFrom(int first = 0) const;
};

}  // namespace plumbline
