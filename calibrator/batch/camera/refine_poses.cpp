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

std::vector<FrameView> viewsOf(const CameraProblem& problem, const CameraEstimate& estimate,
                               std::size_t f) {
  std::vector<FrameView> views;
  for (std::size_t c = 0; c < estimate.intrinsics.size(); ++c) {
    const int index = problem.frames[f].view[c];
    if (index < 0) continue;
    views.push_back(
        {&estimate.intrinsics[c], problem.corners[c].view(index), estimate.T_C0Ci[c].inverse()});
  }
  return views;
}

}  // namespace

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
      const PoseRefinement refined =
          refinePose(viewsOf(problem, estimate, f), estimate.T_C0F[f], options);
      estimate.T_C0F[f] = refined.T_C0F;
      out.cost[f] = refined.cost;
      settled[f] = refined.converged ? 1 : 0;
    }
  });
  out.converged = std::all_of(settled.begin(), settled.end(), [](char s) { return s != 0; });
  return out;
}

}  // namespace plumbline
