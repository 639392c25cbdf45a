// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/results.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/guidance/guide_options.h"
#include "calibrator/initialise/camera_poses.h"

namespace plumbline {

/// Corners of one frame, per camera; ids ascending; empty where a camera has no view.
using FrameCorners = std::vector<std::vector<Corner>>;

/// The views of a frame that hold at least so many corners; the others are empty.
FrameCorners usableViews(const GuideFrame& frame, std::size_t cameras, int min_corners);

/// No camera has a view.
bool seesNothing(const FrameCorners& corners);

/// Whether some camera's view moved by more than `least_px` (mean corner distance), or shows other
/// parts of the target, or is there when it was not before.
bool hasMoved(const FrameCorners& before, const FrameCorners& now, double least_px);

/// A frame's corners as poses and information are found from them.
struct PackedFrame {
  std::vector<PackedCorners> corners;  ///< per camera, also of one without corners

  PackedFrame() = default;
  PackedFrame(const AprilGrid& target, const FrameCorners& seen);
  /// Of the cameras that have corners. The estimate and this frame must outlive them.
  std::vector<FrameView> views(const CameraEstimate& cameras) const;
};

/// T_FC0 from one frame's corners at known cameras, from nothing; empty where what remains is more
/// than 1.5 % of the image's width.
std::optional<Transform> poseOf(const AprilGrid& target, const CameraEstimate& cameras,
                                const FrameCorners& corners, double cauchy_px);

/// A frame that a stage has accepted.
struct KeptFrame {
  int index = 0;  ///< position in the recording
  TimeNs t = 0;
  FrameCorners corners;
};

/// What the cameras of a rig saw in frames that were kept. Views of a frame keep its stamp, by
/// which the batch pairs them again.
template <class Kept>
Session sessionOf(const GuideRig& rig, const std::vector<Kept>& frames) {
  Session session;
  session.target = rig.target;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    CameraStream& stream = session.cameras.emplace_back();
    stream.name = rig.cameras[c].name;
    stream.resolution = rig.cameras[c].resolution;
    for (const Kept& frame : frames) {
      if (!frame.corners[c].empty()) stream.views.push_back({frame.t, frame.corners[c]});
    }
  }
  return session;
}

/// Batch over frames of the guide: calibrateCameras() as the guide's options have it, from `start`
/// or, where that is empty, from the views alone.
Result<CameraStageResult> calibrateFrames(const GuideRig& rig, const std::vector<KeptFrame>& frames,
                                          const GuideOptions& options,
                                          const std::vector<CameraCalibration>& start = {});

/// Only the frames' poses move; the cameras are given.
Result<CameraStageResult> scoreFrames(const GuideRig& rig, const std::vector<KeptFrame>& frames,
                                      const GuideOptions& options,
                                      const std::vector<CameraCalibration>& cameras);

/// Whether the camera stage started at a wrong minimum, under which every frame may yet have a
/// plausible pose: frames after the start that moved against each other are calibrated by
/// themselves, from nothing, once there are 10, 20 and 40 of them. The estimate was wrong where it
/// leaves 1.25 times the RMSE on them, only poses moved.
class StartCheck {
 public:
  StartCheck(const GuideRig& rig, const GuideOptions& options) : rig_(rig), options_(options) {}

  /// A frame with a plausible pose; whether the frames so far are now to be compared.
  bool isDue(const GuideFrame& frame, const FrameCorners& corners);
  /// What speaks against the cameras; empty: nothing.
  std::optional<std::string> against(const std::vector<CameraCalibration>& cameras) const;
  /// The stage restarts.
  void forget() { frames_.clear(); }

 private:
  GuideRig rig_;
  GuideOptions options_;
  std::vector<KeptFrame> frames_;
};

/// Mean distance of the corners that both lists hold [px]; ids ascending. Empty where fewer than
/// four are in both.
std::optional<double> meanCornerDistance(const std::vector<Corner>& a,
                                         const std::vector<Corner>& b);

/// A suggestion that waits for the operator.
class OpenSuggestion {
 public:
  /// `corners`: what the suggestion's camera would see there.
  OpenSuggestion(Suggestion suggestion, std::vector<Corner> corners, const ReachRule& rule);

  struct Progress {
    SuggestionEvent event = SuggestionEvent::kNone;  ///< none, reached, expired
    std::optional<double> distance_px;
    double held_s = 0;
  };
  /// With every frame: what the suggestion's camera saw (empty: nothing).
  Progress update(TimeNs t, const std::vector<Corner>& seen);

  /// It is taken to have been shown at `t`.
  void restart(TimeNs t);

  const Suggestion& suggestion() const { return suggestion_; }

 private:
  Suggestion suggestion_;
  std::vector<Corner> corners_;
  ReachRule rule_;
  std::optional<TimeNs> near_since_;
};

/// Why a first frame leaves the estimate (FrameGate::replacesFirst()).
constexpr const char* kWrongFirstStamp = "its stamp is far from those of the frames after it";

/// Which frames a stage of the guide looks at: those whose stamp is after all before, that come
/// when it is not busy, and that show the target. A stamp more than ten times max_frame_gap_s, and
/// 5 s, after the one before holds its frame back; the next frame shows whether there was a pause
/// or the stamp was wrong, and only a pause counts. Two frames in order that are so far before or
/// after the only frame until then replace it, and time begins with them. What holds a frame back,
/// a pause before it, time that begins anew, and a target that is long out of view are said in the
/// decision.
class FrameGate {
 public:
  /// `last`: stamp of the frame before the first that will arrive.
  explicit FrameGate(const GuideOptions& options,
                     TimeNs busy_until = std::numeric_limits<TimeNs>::min(),
                     std::optional<TimeNs> last = std::nullopt);

  /// After a pause the time that the rig has been near `open` begins again.
  bool arrives(const GuideFrame& frame, std::optional<OpenSuggestion>& open, Decision& d);
  /// Of a frame that arrived: the only one before it had a wrong stamp, and is to be left out.
  bool replacesFirst() const { return replaces_first_; }
  /// Stamp of the first frame that arrived, or of the one that replaced it; empty before.
  std::optional<TimeNs> since() const { return since_; }
  /// Of a frame that arrived: whether it `shows` the target.
  bool hasTarget(bool shows, Decision& d);
  /// Of the frames before the last one [s]; longer than max_frame_gap_s: a jump.
  bool isAfterPause() const { return pause_s_ > max_gap_s_; }

  /// Busy from a frame's stamp on: decisions depend on the recording alone, not on the machine that
  /// replays it. More work adds to it.
  void work(TimeNs from, double s) { busy_until_ = from + toNanoseconds(s); }
  void workOn(double s) { busy_until_ += toNanoseconds(s); }
  TimeNs busyUntil() const { return busy_until_; }

 private:
  bool isInOrder(TimeNs t, TimeNs before, Decision& d);
  void startAnew(TimeNs t, std::optional<OpenSuggestion>& open);

  double lost_target_s_, max_gap_s_, far_s_;
  TimeNs busy_until_;
  std::optional<TimeNs> since_;       // when time begins
  std::optional<TimeNs> last_;        // frame, whatever it showed
  std::optional<TimeNs> doubted_;     // stamp of the frame just before, held back as too far off
  std::optional<TimeNs> lost_since_;  // empty: the last frame looked at showed the target
  double pause_s_ = 0;
  bool is_only_ = false;  // of all frames, only the last one has arrived
  bool replaces_first_ = false;
  bool lost_said_ = false;
};

/// Of a frame that nobody has looked at.
Decision decisionOn(const GuideFrame& frame, GuideStage stage, double threshold_nats = 0);

/// What both stages of the guide keep beside their estimates.
struct StageState {
  GuideRig rig;
  GuideOptions options;
  FrameGate gate;
  int next_suggestion = 0;
  int frames_without_view = 0;
  bool finished = false;
  std::optional<OpenSuggestion> open = {};

  /// Opens a suggestion whose id and stage are not written yet; `corners`: see OpenSuggestion.
  void show(Suggestion s, std::vector<Corner> corners, const ReachRule& rule, Decision& d);
  /// Progress towards the suggestion that is open, with every frame, target or not.
  void follow(const GuideFrame& frame, Decision& d);
  /// The suggestion that is open is taken back.
  void withdrawOpen(Decision& d);
  /// Nothing is left to ask for; what follows keeps the guide busy for `batch_s`.
  void finish(double batch_s, Decision& d);
  /// What holds after the frame; `started`: the estimate stands.
  void tell(bool started, std::size_t kept, Decision& d) const;
};

}  // namespace plumbline
