// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/guide.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "calibrator/guidance/guide_stage.h"

namespace plumbline {

Guide::Guide(const GuideRig& rig, const GuideOptions& options,
             std::optional<std::vector<CameraCalibration>> cameras)
    : rig_(rig), options_(options) {
  options.check();
  if (!cameras) {
    camera_.emplace(rig, options);
  } else if (rig.imu) {
    // Without IMU, and with the cameras given, there is nothing to guide.
    camera_imu_.emplace(rig, std::move(*cameras), options);
  }
}

void Guide::endCameraStage(Decision& last) {
  camera_batch_ = camera_->batch();
  if (!camera_batch_->ok()) {
    note(last, "the batch over the views kept failed");
    last.failure = camera_batch_->failure();
  } else if (rig_.imu) {
    // The batch goes on while the next frames come; they are dropped.
    TimeNs busy_until = camera_->busyUntil();
    // A stage that finishes itself accounts for its batch.
    if (camera_ended_) {
      busy_until = std::max(busy_until, last.t) + toNanoseconds(options_.latency.camera_batch_s);
    }
    // The batch's cameras, not the window's: they are what the operator is given.
    // Ids have no hole: that of a suggestion that was never shown is given again.
    camera_imu_.emplace(
        rig_, camera_batch_->value().cameras, options_,
        StageBegin{camera_->nextSuggestion() - (never_shown_ ? 1 : 0), busy_until, last.t});
  }
}

/// What is still open is taken back with the frame; one that this frame opened was never shown.
void Guide::endByTime(Decision& last) {
  camera_ended_ = true;
  last.mode = GuideMode::kFinished;
  if (last.event == SuggestionEvent::kOpened) {
    never_shown_ = true;
    last.event = SuggestionEvent::kNone;
    last.suggestion.reset();
    last.opened.reset();
  } else if (last.event == SuggestionEvent::kNone && last.suggestion) {
    last.event = SuggestionEvent::kWithdrawn;
  }
  note(last, "the stage is ended here without having said stop");
}

Decision Guide::stepCamera(const GuideFrame& frame) {
  Decision decision = camera_->step(frame);
  // A frame whose stamp is held to be wrong does not say that the time is over.
  const bool in_order = decision.reason != GuideReason::kTimeJump;
  if (options_.camera_stage_s > 0 && in_order && !camera_->finished() &&
      secondsBetween(*camera_->since(), frame.t) >= options_.camera_stage_s) {
    endByTime(decision);
  }
  if (cameraOver()) endCameraStage(decision);
  return decision;
}

Decision Guide::step(const GuideFrame& frame) {
  assert(frame.corners.size() == rig_.cameras.size());
  if (camera_ && !cameraOver()) return stepCamera(frame);
  if (camera_imu_) return camera_imu_->step(frame);
  // A stage that finished says so with every frame; one that was ended by time would go on.
  if (camera_ && !camera_ended_) return camera_->step(frame);
  Decision passed_over = decisionOn(frame, GuideStage::kCamera);
  passed_over.reason = GuideReason::kFinished;
  passed_over.mode = GuideMode::kFinished;
  return passed_over;
}

bool Guide::finished() const {
  if (camera_imu_) return camera_imu_->finished();
  return !camera_ || cameraOver();
}

std::optional<TimeNs> Guide::since() const {
  if (camera_) return camera_->since();
  return camera_imu_ ? camera_imu_->since() : std::nullopt;
}

Result<CameraStageResult> Guide::cameraBatch() const {
  if (camera_batch_) return *camera_batch_;
  // The cameras were given.
  if (!camera_) return Failure{FailureCode::kStageNotBegun, {{"stage", "camera"}}};
  return camera_->batch();
}

}  // namespace plumbline
