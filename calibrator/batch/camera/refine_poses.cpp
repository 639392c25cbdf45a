// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <numeric>

#include "calibrator/base/parallel.h"
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

double RefinedPoses::total(double pixel_sigma) const {
  return 0.5 * std::accumulate(cost.begin(), cost.end(), 0.) / (pixel_sigma * pixel_sigma);
}

RefinedPoses refinePoses(const CameraProblem& problem, CameraEstimate& estimate) {
  const PoseRefinementOptions options{problem.gram, kIterations, kTolerance};
  RefinedPoses out;
  out.cost.assign(problem.frames.size(), 0);
  // No vector of bool, of which threads would write into one word.
  std::vector<char> settled(problem.frames.size(), 0);
  forChunks(problem.frameCount(), kFrameChunk, problem.threads, [&](const Chunk& chunk) {
    for (int i = chunk.begin; i < chunk.end; ++i) {
      const auto f = static_cast<std::size_t>(i);
      // Cameras and board held, frames have nothing in common: each is a problem of six unknowns.
      const PoseRefinement refined = refinePose(
          frameViews(problem.frames[f], problem.corners, estimate), estimate.T_C0F[f], options);
      estimate.T_C0F[f] = refined.T_C0F;
      out.cost[f] = refined.cost;
      settled[f] = refined.converged ? 1 : 0;
    }
  });
  out.converged = std::all_of(settled.begin(), settled.end(), [](char s) { return s != 0; });
  return out;
}

}  // namespace plumbline
