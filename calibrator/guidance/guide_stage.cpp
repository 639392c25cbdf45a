// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/guide_stage.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/initialise/camera_start.h"

namespace plumbline {
namespace {

// A stamp so many max_frame_gap_s from the frame before is doubted until the next frame confirms
// it.
constexpr double kFarPauses = 10;
// But not a nearer one [s]: frames of a slow camera are seconds apart where some are lost, also
// where a short max_frame_gap_s is asked for.
constexpr double kLeastFarS = 5;

// Over the image's width, for errors of a young estimate grow with it. A first pose is robust at a
// scale (kRoughLoss) far above noise, settles where no better start is worth trying (kGoodPose),
// and is refused where the cameras cannot be blamed for it (kWorstPose: 11 px of 752).
constexpr double kRoughLoss = 0.01;
constexpr double kGoodPose = 0.005;
constexpr double kWorstPose = 0.015;

// Of StartCheck.
constexpr std::size_t kFirstCheck = 10;
// Noise, and a model that misfits (EuRoC, radtan without loss), make it up to 1.01.
constexpr double kWorseStart = 1.25;

CameraStageOptions stageOptions(const GuideRig& rig, const GuideOptions& options) {
  CameraStageOptions stage;
  for (const GuideRig::Camera& camera : rig.cameras) stage.models.push_back(camera.model);
  stage.model() = options.views.model();
  stage.threads = options.threads;
  return stage;
}

}  // namespace

FrameCorners usableViews(const GuideFrame& frame, std::size_t cameras, int min_corners) {
  FrameCorners usable(cameras);
  for (std::size_t c = 0; c < cameras && c < frame.corners.size(); ++c) {
    if (static_cast<int>(frame.corners[c].size()) >= min_corners) usable[c] = frame.corners[c];
  }
  return usable;
}

bool seesNothing(const FrameCorners& corners) {
  return std::all_of(corners.begin(), corners.end(), [](const auto& view) { return view.empty(); });
}

bool hasMoved(const FrameCorners& before, const FrameCorners& now, double least_px) {
  for (std::size_t c = 0; c < now.size(); ++c) {
    // A camera that has lost the board says nothing of movement.
    if (now[c].empty()) continue;
    const auto distance = meanCornerDistance(before[c], now[c]);
    // Too few corners in common: another part of the board is in view.
    if (!distance || *distance > least_px) return true;
  }
  return false;
}

PackedFrame::PackedFrame(const AprilGrid& target, const FrameCorners& seen) {
  for (const std::vector<Corner>& camera : seen) {
    corners.emplace_back(target, std::vector<ImageView>{{0, camera}});
  }
}

std::vector<FrameView> PackedFrame::views(const CameraEstimate& cameras) const {
  std::vector<FrameView> views;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const PackedView view = corners[c].view(0);
    if (view.count == 0) continue;
    views.push_back({&cameras.intrinsics[c], view, cameras.T_C0Ci[c].inverse()});
  }
  return views;
}

std::optional<Transform> poseOf(const AprilGrid& target, const CameraEstimate& cameras,
                                const FrameCorners& corners, double cauchy_px) {
  const PackedFrame packed(target, corners);
  const std::vector<FrameView> views = packed.views(cameras);
  const double width = rmsWidth(views);
  PoseRefinementOptions rough;
  rough.gram.cauchy_px = kRoughLoss * width;
  const auto found = findPose(views, kGoodPose * width, rough);
  if (!found || !(found->errorPx() < kWorstPose * width)) return std::nullopt;
  // From there under the window's own loss, which would not have led there from afar.
  PoseRefinementOptions fine;
  fine.gram.cauchy_px = cauchy_px;
  return refinePose(views, found->T_C0F, fine).T_C0F.inverse();
}

Result<CameraStageResult> calibrateFrames(const GuideRig& rig, const std::vector<KeptFrame>& frames,
                                          const GuideOptions& options,
                                          const std::vector<CameraCalibration>& start) {
  CameraStageOptions stage = stageOptions(rig, options);
  stage.start = start;
  return calibrateCameras(sessionOf(rig, frames), stage);
}

Result<CameraStageResult> scoreFrames(const GuideRig& rig, const std::vector<KeptFrame>& frames,
                                      const GuideOptions& options,
                                      const std::vector<CameraCalibration>& cameras) {
  return scoreCameras(sessionOf(rig, frames), cameras, stageOptions(rig, options));
}

bool StartCheck::isDue(const GuideFrame& frame, const FrameCorners& corners) {
  if (frames_.size() >= 4 * kFirstCheck) return false;
  const double move_px = options_.views.start_move_px;
  if (!frames_.empty() && !hasMoved(frames_.back().corners, corners, move_px)) return false;
  frames_.push_back({frame.index, frame.t, corners});
  const std::size_t n = frames_.size();
  // Each after twice as many, so that all checks together cost less than two of the last.
  return n == kFirstCheck || n == 2 * kFirstCheck || n == 4 * kFirstCheck;
}

std::optional<std::string> StartCheck::against(
    const std::vector<CameraCalibration>& cameras) const {
  const auto restart = calibrateFrames(rig_, frames_, options_);
  const auto given = scoreFrames(rig_, frames_, options_, cameras);
  if (!restart || !given) return std::nullopt;
  // Scored as the given ones are, for a calibration leaves out corners that a score does not.
  const auto scored = scoreFrames(rig_, frames_, options_, restart->cameras);
  if (!scored) return std::nullopt;
  const double restart_px = scored->summary.reprojection.rmse_px;
  const double given_px = given->summary.reprojection.rmse_px;
  // Cameras made from these very frames fit them better than any others: only a clear excess blames
  // the start.
  if (!(given_px > kWorseStart * std::max(restart_px, kNoiseFloorPx))) return std::nullopt;
  return fmt::format(
      "the estimate has {:.2f} px RMSE on {} frames after its start, an estimate from those frames "
      "alone {:.2f} px",
      given_px, frames_.size(), restart_px);
}

std::optional<double> meanCornerDistance(const std::vector<Corner>& a,
                                         const std::vector<Corner>& b) {
  constexpr int kLeast = 4;  // fewer corners in common say nothing of a view
  double sum = 0;
  int common = 0;
  // Ids ascend in both: one pass finds those in common.
  for (auto i = a.begin(), j = b.begin(); i != a.end() && j != b.end();) {
    if (i->id < j->id) {
      ++i;
    } else if (j->id < i->id) {
      ++j;
    } else {
      sum += (i->uv - j->uv).norm();
      ++common, ++i, ++j;
    }
  }
  if (common < kLeast) return std::nullopt;
  return sum / common;
}

OpenSuggestion::OpenSuggestion(Suggestion suggestion, std::vector<Corner> corners,
                               const ReachRule& rule)
    : suggestion_(std::move(suggestion)), corners_(std::move(corners)), rule_(rule) {}

OpenSuggestion::Progress OpenSuggestion::update(TimeNs t, const std::vector<Corner>& seen) {
  Progress now;
  now.distance_px = meanCornerDistance(corners_, seen);
  if (!now.distance_px || *now.distance_px > rule_.reached_px) {
    // A single frame off, or without the target, begins the hold anew.
    near_since_.reset();
  } else if (!near_since_) {
    near_since_ = t;
  }
  if (near_since_) now.held_s = secondsBetween(*near_since_, t);
  // Reached wins over expired: who holds the view when time is up has followed it.
  if (near_since_ && now.held_s >= rule_.reached_s) {
    now.event = SuggestionEvent::kReached;
  } else if (secondsBetween(suggestion_.t, t) > rule_.expires_s) {
    now.event = SuggestionEvent::kExpired;
  }
  return now;
}

void OpenSuggestion::restart(TimeNs t) {
  suggestion_.t = t;
  near_since_.reset();
}

FrameGate::FrameGate(const GuideOptions& options, TimeNs busy_until, std::optional<TimeNs> last)
    : lost_target_s_(options.lost_target_s),
      max_gap_s_(options.max_frame_gap_s),
      far_s_(std::max(kFarPauses * options.max_frame_gap_s, kLeastFarS)),
      busy_until_(busy_until),
      last_(last) {}

/// Nothing that the first frame's stamp began goes on.
void FrameGate::startAnew(TimeNs t, std::optional<OpenSuggestion>& open) {
  since_ = busy_until_ = t;
  lost_since_.reset();
  lost_said_ = false;
  if (open) open->restart(t);
}

/// Whether the frame's stamp is to be believed; says in `d` why not. `before` is the stamp of the
/// frame before it.
bool FrameGate::isInOrder(TimeNs t, TimeNs before, Decision& d) {
  const std::optional<TimeNs> held = std::exchange(doubted_, std::nullopt);
  const bool far = std::abs(pause_s_) > far_s_;
  const bool confirms = far && held && t > *held && secondsBetween(*held, t) <= far_s_;
  replaces_first_ = confirms && is_only_;
  if (replaces_first_) {
    note(d, fmt::format("time begins anew: the only frame before is {:.3f} s {} it",
                        std::abs(pause_s_), pause_s_ > 0 ? "before" : "after"));
    pause_s_ = secondsBetween(*held, t);
    return true;
  }
  if (t > before && (!far || confirms)) return true;
  // Also far before the only frame, which may be the one that is wrong.
  if (far && (t > before || is_only_)) doubted_ = t;
  d.reason = GuideReason::kTimeJump;
  if (t > before) {
    note(d, fmt::format("its stamp is {:.6f} s after that of the frame before and may be wrong: "
                        "not used",
                        pause_s_));
  } else {
    note(d, t == before
                ? "its stamp is not after that of the frame before: not used"
                : fmt::format("its stamp is {:.6f} s before that of the frame before: not used",
                              -pause_s_));
  }
  return false;
}

bool FrameGate::arrives(const GuideFrame& frame, std::optional<OpenSuggestion>& open, Decision& d) {
  // The first frame comes 1 ns after nothing: neither a jump nor a pause.
  const TimeNs before = last_.value_or(frame.t - 1);
  pause_s_ = last_ ? secondsBetween(before, frame.t) : 0;
  if (!isInOrder(frame.t, before, d)) return false;
  if (replaces_first_) startAnew(frame.t, open);
  if (!since_) since_ = frame.t;
  // Before the answer: frames that come while the guide is busy are no pause of the camera.
  is_only_ = !last_;
  last_ = frame.t;
  if (isAfterPause()) {
    note(d, fmt::format("no frame for {:.3f} s before it", pause_s_));
    // Nobody saw where the camera was meanwhile.
    if (open && !replaces_first_) open->update(before, {});
  }
  if (frame.t >= busy_until_) return true;
  d.reason = GuideReason::kBusy;
  return false;
}

bool FrameGate::hasTarget(bool shows, Decision& d) {
  // From the frame before the first without it, also where that was dropped: of the time of work,
  // or of a pause, nobody knows. A target that was never seen counts as lost from the first frame
  // on.
  if (!shows && (!lost_since_ || (isAfterPause() && !lost_said_))) {
    lost_since_ = isAfterPause() ? d.t : d.t - toNanoseconds(pause_s_);
  }
  const double lost_s = lost_since_ ? secondsBetween(*lost_since_, d.t) : 0;
  if (shows) {
    if (std::exchange(lost_said_, false)) {
      note(d, fmt::format("the target is back after {:.3f} s out of view", lost_s));
    }
    lost_since_.reset();
    return true;
  }
  d.reason = GuideReason::kNoTarget;
  if (!lost_said_ && lost_s > lost_target_s_) {
    lost_said_ = true;
    note(d, fmt::format("the target has been out of view for {:.3f} s", lost_s));
  }
  return false;
}

Decision decisionOn(const GuideFrame& frame, GuideStage stage, double threshold_nats) {
  Decision d;
  d.t = frame.t;
  d.frame = frame.index;
  d.stage = stage;
  d.threshold_nats = threshold_nats;
  for (const std::vector<Corner>& view : frame.corners) d.corners += static_cast<int>(view.size());
  return d;
}

void StageState::show(Suggestion s, std::vector<Corner> corners, const ReachRule& rule,
                      Decision& d) {
  s.id = next_suggestion++;
  s.stage = d.stage;
  open.emplace(s, std::move(corners), rule);
  d.event = SuggestionEvent::kOpened;
  d.suggestion = s.id;
  d.opened = std::move(s);
}

void StageState::follow(const GuideFrame& frame, Decision& d) {
  if (!open) return;
  const auto camera = static_cast<std::size_t>(open->suggestion().camera);
  const OpenSuggestion::Progress progress = open->update(frame.t, frame.corners[camera]);
  d.event = progress.event;
  d.suggestion = open->suggestion().id;
  d.distance_px = progress.distance_px;
  d.held_s = progress.held_s;
  if (progress.event != SuggestionEvent::kNone) open.reset();
}

void StageState::withdrawOpen(Decision& d) {
  if (!open) return;
  d.event = SuggestionEvent::kWithdrawn;
  d.suggestion = open->suggestion().id;
  open.reset();
}

void StageState::finish(double batch_s, Decision& d) {
  finished = true;
  gate.workOn(batch_s);
  withdrawOpen(d);
}

void StageState::tell(bool started, std::size_t kept, Decision& d) const {
  d.mode = finished   ? GuideMode::kFinished
           : !started ? GuideMode::kInitialising
           : open     ? GuideMode::kSuggesting
                      : GuideMode::kCollecting;
  d.views_kept = static_cast<int>(kept);
  d.frames_without_view = frames_without_view;
}

}  // namespace plumbline
