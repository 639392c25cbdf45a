// SPDX-License-Identifier: BSD-3-Clause
#include <utility>
#include <vector>

#include "calibrator/base/time.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/batch/camera/stage.h"
#include "calibrator/batch/corners.h"

namespace plumbline {

Result<CameraStageResult> scoreCameras(const Session& session,
                                       const std::vector<CameraCalibration>& cameras,
                                       const CameraStageOptions& options) {
  options.check();
  checkSession(session);
  checkCameras(session, cameras);
  Stopwatch watch;
  std::vector<PackedCorners> corners = packCorners(session);
  auto start =
      startFromCameras(cameras, corners, pairFrames(session.cameras, options.frames), options);
  if (!start) return start.failure();
  CameraProblem problem = problemOf(corners, std::move(start.value().frames), options);
  CameraEstimate estimate = std::move(start.value().estimate);
  const double initialise_s = watch.lap();
  RefinedPoses poses = refinePoses(problem, estimate);
  // Not those beyond kGrazing: which they are depends on the lens, and a bad one would gain by it.
  const auto misplaced = misplacedCorners(session.target, problem, estimate);
  weigh(misplaced, 0, corners);
  if (!misplaced.empty()) poses = refinePoses(problem, estimate);
  if (rejectCorners(problem, estimate, options, corners) > 0) {
    // Few corners are left where a filter took nearly all of them: no pose follows from those.
    const int frames = problem.frameCount();
    dropBareFrames(problem, estimate);
    if (problem.frames.empty()) return Failure{FailureCode::kNoFramePose, {{"frames", frames}}};
    poses = refinePoses(problem, estimate);
  }
  CameraStageResult result = resultFrom(session, problem, estimate);
  addResiduals(session, problem, estimate, ResidualList::kKeep, result);
  result.summary.converged = poses.converged;
  result.summary.cost = poses.total(problem.pixel_sigma);
  result.summary.seconds.initialise = initialise_s;
  result.summary.seconds.solve = watch.lap();
  result.summary.seconds.total = initialise_s + result.summary.seconds.solve;
  return result;
}

}  // namespace plumbline
