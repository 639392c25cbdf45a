// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/imu_stage_start.h"

#include "calibrator/batch/camera_imu/stage.h"

namespace plumbline {
namespace {

Failure notConverged() { return {FailureCode::kFirstFramesNotConverged}; }

CameraImuEstimate estimateOf(const CameraImuStageResult& result) {
  CameraImuEstimate estimate;
  estimate.T_SC0 = result.imu.T_SC0;
  estimate.gravity_direction = result.gravity_F.normalized();
  estimate.time_offset_s = result.imu.time_offset_s;
  estimate.cameras = result.cameras;
  return estimate;
}

}  // namespace

Result<CameraImuWindow> startImuWindow(const ImuStageRecording& recording,
                                       const std::vector<CameraCalibration>& cameras,
                                       const TrajectoryGuideOptions& options) {
  const Session session = recording.session();
  CameraImuOptions batch = recording.batchOptions();
  batch.noise_check = false;
  const auto result = calibrateCameraImu(session, cameras, batch);
  if (!result) return result.failure();
  if (!result->summary.converged) return notConverged();
  CameraImuProblem problem = makeProblem(session, batch);
  problem.view_stamps.clear();
  CameraImuEstimate estimate = estimateOf(*result);
  std::vector<TimeNs> stamps;
  for (const Frame& frame : result->frames) stamps.push_back(frame.t);
  const auto selection =
      selectFrames(stamps, problem.samples, imuGaps(problem.samples, batch.max_gap_intervals),
                   selectionOptions(batch, estimate.time_offset_s));
  for (const int i : selection.chosen) {
    problem.frames.push_back(result->frames[static_cast<std::size_t>(i)]);
    estimate.states.push_back(result->states[static_cast<std::size_t>(i)]);
  }
  if (problem.frameCount() <= options.window) return notConverged();
  problem.links = selection.links;
  problem.weights.assign(problem.frames.size(), 1);
  CameraImuWindowOptions size;
  size.states = options.window;
  auto window = CameraImuWindow::fromBatch(problem, estimate, session.target, size);
  if (!window) return notConverged();
  return std::move(*window);
}

}  // namespace plumbline
