// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/guide.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "calibrator/base/option_check.h"
#include "calibrator/guidance/guide_stage.h"

namespace plumbline {

void ViewGuideOptions::check() const {
  MeasurementModel::check();
  requireOption(start_frames >= 2, "views.start_frames", start_frames, "2 or more");
  requireOption(start_move_px >= 0, "views.start_move_px", start_move_px, "0 or more");
  requireOption(start_anew_after >= 1, "views.start_anew_after", start_anew_after, "1 or more");
  requireOption(window >= 1, "views.window", window, "1 or more");
  // A homography, with which every pose begins, needs four.
  requireOption(min_corners >= 4, "views.min_corners", min_corners, "4 or more");
  requireOption(threshold_nats >= 0, "views.threshold_nats", threshold_nats, "0 or more");
  requireOption(least_lowering > 0 && least_lowering < 1, "views.least_lowering", least_lowering,
                "a share between 0 and 1");
  requirePositive("views.stop_excess", stop_excess);
  requireOption(stop_views >= 2, "views.stop_views", stop_views, "2 or more");
  requireOption(stop_projection_px >= 0, "views.stop_projection_px", stop_projection_px,
                "0 (not asked for) or more");
  requireOption(patience >= 1, "views.patience", patience, "1 or more");
  requirePositive("views.reached_px", reached_px);
  requireOption(reached_s >= 0, "views.reached_s", reached_s, "0 or more");
  requirePositive("views.expires_s", expires_s);
  requireOption(min_views >= 0, "views.min_views", min_views, "0 or more");
}

void TrajectoryGuideOptions::check() const {
  MeasurementModel::check();
  requireOption(start_frames >= 3, "trajectories.start_frames", start_frames, "3 or more");
  requireOption(window >= 2, "trajectories.window", window, "2 or more");
  // Without a frame that leaves the window there would be no prior to begin with.
  requireOption(start_frames > window, "trajectories.start_frames", start_frames,
                "more than trajectories.window");
  requireOption(min_corners >= 4, "trajectories.min_corners", min_corners, "4 or more");
  requireOption(threshold_nats >= 0, "trajectories.threshold_nats", threshold_nats, "0 or more");
  requireOption(least_lowering > 0 && least_lowering < 1, "trajectories.least_lowering",
                least_lowering, "a share between 0 and 1");
  requireOption(stop_reprojection_px >= 0, "trajectories.stop_reprojection_px",
                stop_reprojection_px, "0 (not asked for) or more");
  requirePositive("trajectories.evaluate_every_s", evaluate_every_s);
  requirePositive("trajectories.reached_px", reached_px);
  requireOption(reached_s >= 0, "trajectories.reached_s", reached_s, "0 or more");
  requirePositive("trajectories.expires_s", expires_s);
  requirePositive("trajectories.amplitude", amplitude);
  requirePositive("trajectories.duration_s", duration_s);
  requirePositive("trajectories.max_speed_m_s", max_speed_m_s);
  requirePositive("trajectories.max_rate_rad_s", max_rate_rad_s);
  requirePositive("trajectories.max_acceleration_m_s2", max_acceleration_m_s2);
}

TrajectoryGuideOptions TrajectoryGuideOptions::patient() {
  TrajectoryGuideOptions o;
  o.first = FirstTrajectory::kScored;
  o.reached_s = 1;
  o.amplitude = 1;
  o.duration_s = 5;
  return o;
}

void GuideLatency::check() const {
  for (const double s : {camera_start_s, camera_frame_s, next_view_s, camera_batch_s, imu_start_s,
                         imu_frame_s, trajectories_s, imu_batch_s}) {
    requireWithin(0, 60, "latency of a step [s]", s);
  }
}

void GuideOptions::check() const {
  views.check();
  trajectories.check();
  latency.check();
  pace.check();
  requireOption(camera_stage_s >= 0, "camera_stage_s", camera_stage_s, "0 (no limit) or more");
  requireOption(lost_target_s > 0, "lost_target_s", lost_target_s, "a positive time");
  requireOption(max_frame_gap_s > 0, "max_frame_gap_s", max_frame_gap_s, "a positive time");
  requireOption(threads >= 1, "threads", threads, "1 or more");
}

struct Guide::State {
  GuideRig rig;
  GuideOptions options;
  std::optional<CameraGuide> camera;                      // unless cameras were given
  std::optional<Result<CameraStageResult>> camera_batch;  // once the camera stage is over
  std::optional<CameraImuGuide> camera_imu;               // while and after it runs
  bool camera_ended = false;                              // by options.camera_stage_s
  bool never_shown = false;                               // what its last frame opened

  bool cameraOver() const { return camera_ended || camera->finished(); }
  Decision stepCamera(const GuideFrame& frame);
  void endByTime(Decision& last);
  void endCameraStage(Decision& last);
};

Guide::Guide(const GuideRig& rig, const GuideOptions& options,
             std::optional<std::vector<CameraCalibration>> cameras)
    : state_(std::make_unique<State>()) {
  options.check();
  state_->rig = rig;
  state_->options = options;
  if (!cameras) {
    state_->camera.emplace(rig, options);
  } else if (rig.imu) {
    // Without IMU, and with the cameras given, there is nothing to guide.
    state_->camera_imu.emplace(rig, std::move(*cameras), options);
  }
}

Guide::~Guide() = default;
Guide::Guide(Guide&&) noexcept = default;

namespace {

/// Of a frame that no stage looks at.
Decision passedOver(const GuideFrame& frame) {
  Decision decision = decisionOn(frame, GuideStage::kCamera);
  decision.reason = GuideReason::kFinished;
  decision.mode = GuideMode::kFinished;
  return decision;
}

}  // namespace

void Guide::State::endCameraStage(Decision& last) {
  camera_batch = camera->batch();
  if (!camera_batch->ok()) {
    note(last, "the batch over the views kept failed");
    last.failure = camera_batch->failure();
  } else if (rig.imu) {
    // The batch goes on while the next frames come; they are dropped.
    TimeNs busy_until = camera->busyUntil();
    // A stage that finishes itself accounts for its batch.
    if (camera_ended) {
      busy_until = std::max(busy_until, last.t) + toNanoseconds(options.latency.camera_batch_s);
    }
    // The batch's cameras, not the window's: they are what the operator is given.
    // Ids have no hole: that of a suggestion that was never shown is given again.
    camera_imu.emplace(rig, camera_batch->value().cameras, options,
                       CameraImuGuide::Begin{camera->nextSuggestion() - (never_shown ? 1 : 0),
                                             busy_until, last.t});
  }
}

/// What is still open is taken back with the frame; one that this frame opened was never shown.
void Guide::State::endByTime(Decision& last) {
  camera_ended = true;
  last.mode = GuideMode::kFinished;
  if (last.event == SuggestionEvent::kOpened) {
    never_shown = true;
    last.event = SuggestionEvent::kNone;
    last.suggestion.reset();
    last.opened.reset();
  } else if (last.event == SuggestionEvent::kNone && last.suggestion) {
    last.event = SuggestionEvent::kWithdrawn;
  }
  note(last, "the stage is ended here without having said stop");
}

Decision Guide::State::stepCamera(const GuideFrame& frame) {
  Decision decision = camera->step(frame);
  // A frame whose stamp is held to be wrong does not say that the time is over.
  const bool in_order = decision.reason != GuideReason::kTimeJump;
  if (options.camera_stage_s > 0 && in_order && !camera->finished() &&
      secondsBetween(*camera->since(), frame.t) >= options.camera_stage_s) {
    endByTime(decision);
  }
  if (cameraOver()) endCameraStage(decision);
  return decision;
}

Decision Guide::step(const GuideFrame& frame) {
  State& s = *state_;
  assert(frame.corners.size() == s.rig.cameras.size());
  if (s.camera && !s.cameraOver()) return s.stepCamera(frame);
  if (!s.camera_imu) {
    // A stage that finished says so with every frame; one that was ended by time would go on.
    return s.camera && !s.camera_ended ? s.camera->step(frame) : passedOver(frame);
  }
  return s.camera_imu->step(frame);
}

bool Guide::finished() const {
  if (state_->camera_imu) return state_->camera_imu->finished();
  return !state_->camera || state_->cameraOver();
}

bool Guide::cameraStageEnded() const { return state_->camera_ended; }

std::optional<TimeNs> Guide::cameraStageSince() const {
  return state_->camera ? state_->camera->since() : std::nullopt;
}

Result<CameraStageResult> Guide::cameraBatch() const {
  if (state_->camera_batch) return *state_->camera_batch;
  // The cameras were given.
  if (!state_->camera) return Failure{FailureCode::kStageNotBegun, {{"stage", "camera"}}};
  return state_->camera->batch();
}

}  // namespace plumbline
