// SPDX-License-Identifier: BSD-3-Clause
// What moves poses alone, cameras and board held.
#include <numeric>
#include <utility>

#include "calibrator/base/parallel.h"
#include "calibrator/base/time.h"
#include "calibrator/batch/camera/stage.h"
#include "calibrator/initialise/camera_poses.h"

namespace plumbline {
namespace {

constexpr double kTolerance = 1e-6;  // [standard deviations], as the batch's own
constexpr int kIterations = 50;

}  // namespace

// A board under estimation must stand in the corners already (placeCorners()).
std::vector<FrameView> frameViews(const Frame& frame, std::span<const PackedCorners> corners,
                                  const CameraEstimate& cameras) {
  std::vector<FrameView> views;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    if (frame.view[c] < 0) continue;
    views.push_back(
        {&cameras.intrinsics[c], corners[c].view(frame.view[c]), cameras.T_C0Ci[c].inverse()});
  }
  return views;
}

double rmsWidth(const CameraProblem& problem, const CameraEstimate& cameras) {
  std::vector<FrameView> all;
  for (const Frame& frame : problem.frames) {
    for (const FrameView& view : frameViews(frame, problem.corners, cameras)) all.push_back(view);
  }
  return rmsWidth(all);
}

RefinedPoses refinePoses(const CameraProblem& problem, CameraEstimate& estimate) {
  const PoseRefinementOptions options{problem.gram, kIterations, kTolerance};
  // Cameras and board held, frames have nothing in common: each is a problem of six unknowns.
  const auto refined = parallelMap(problem.frames.size(), problem.threads, [&](std::size_t f) {
    return refinePose(frameViews(problem.frames[f], problem.corners, estimate), estimate.T_C0F[f],
                      options);
  });
  RefinedPoses out{{}, true};
  for (std::size_t f = 0; f < refined.size(); ++f) {
    estimate.T_C0F[f] = refined[f].T_C0F;
    out.cost.push_back(refined[f].cost);
    out.converged = out.converged && refined[f].converged;
  }
  return out;
}

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
  result.summary.cost = 0.5 * std::accumulate(poses.cost.begin(), poses.cost.end(), 0.) /
                        (problem.pixel_sigma * problem.pixel_sigma);
  result.summary.seconds.initialise = initialise_s;
  result.summary.seconds.solve = watch.lap();
  result.summary.seconds.total = initialise_s + result.summary.seconds.solve;
  return result;
}

}  // namespace plumbline
