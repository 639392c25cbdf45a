// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/guide.h"

#include <cassert>
#include <utility>

#include "calibrator/guidance/camera_guide.h"
#include "calibrator/guidance/camera_imu_guide.h"

namespace plumbline {

struct Guide::State {
  GuideRig rig;
  GuideOptions options;
  std::optional<CameraGuide> camera;                      // unless cameras were given
  std::optional<Result<CameraStageResult>> camera_batch;  // once the camera stage is over
  std::optional<CameraImuGuide> camera_imu;               // while and after it runs

  Decision stepCamera(const GuideFrame& frame);
  void endCameraStage(Decision& last);
};

Guide::Guide(const GuideRig& rig, const GuideOptions& options,
             std::optional<std::vector<CameraCalibration>> cameras)
    : state_(std::make_unique<State>()) {
  state_->rig = rig;
  state_->options = options;
  if (!cameras) {
    state_->camera.emplace(rig, options);
  } else if (rig.imu) {
    state_->camera_imu.emplace(rig, std::move(*cameras), options);
  }
}

Guide::~Guide() = default;
Guide::Guide(Guide&&) noexcept = default;
Guide& Guide::operator=(Guide&&) noexcept = default;

namespace {

/// Of a frame that no stage looks at.
Decision passedOver(const GuideFrame& frame) {
  Decision decision;
  decision.t = frame.t;
  decision.frame = frame.index;
  decision.stage = GuideStage::kCamera;
  decision.reason = GuideReason::kFinished;
  decision.mode = GuideMode::kFinished;
  for (const std::vector<Corner>& corners : frame.corners)
    decision.corners += static_cast<int>(corners.size());
  return decision;
}

}  // namespace

void Guide::State::endCameraStage(Decision& last) {
  camera_batch = camera->batch();
  if (!camera_batch->ok()) {
    note(last, "the batch over the views kept failed");
    last.failure = camera_batch->failure();
  } else if (rig.imu) {
    camera_imu.emplace(rig, camera_batch->value().cameras, options,
                       CameraImuGuide::Begin{camera->nextSuggestion(), camera->busyUntil()});
  }
}

Decision Guide::State::stepCamera(const GuideFrame& frame) {
  Decision decision = camera->step(frame);
  if (camera->finished()) endCameraStage(decision);
  return decision;
}

Decision Guide::step(const GuideFrame& frame) {
  State& s = *state_;
  assert(frame.corners.size() == s.rig.cameras.size());
  if (s.camera && !s.camera->finished()) return s.stepCamera(frame);
  if (!s.camera_imu) {
    return s.camera ? s.camera->step(frame) : passedOver(frame);
  }
  return s.camera_imu->step(frame);
}

bool Guide::finished() const {
  if (state_->camera_imu) return state_->camera_imu->finished();
  return !state_->camera || state_->camera->finished();
}

namespace {

Failure notRun(const char* stage) { return {FailureCode::kStageNotBegun, {{"stage", stage}}}; }

}  // namespace

Result<CameraStageResult> Guide::cameraBatch() const {
  if (state_->camera_batch) return *state_->camera_batch;
  if (!state_->camera) return notRun("camera");
  return state_->camera->batch();
}

Result<CameraImuStageResult> Guide::cameraImuBatch() const {
  if (!state_->camera_imu) return notRun("camera-IMU");
  return state_->camera_imu->batch();
}

}  // namespace plumbline
