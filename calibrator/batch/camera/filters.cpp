// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "calibrator/base/transform.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/batch/camera/stage.h"
#include "calibrator/batch/corners.h"
#include "calibrator/initialise/screening.h"

namespace plumbline {
namespace {

constexpr int kMinUsedCorners = 4;  // what a frame needs for a pose

/// Camera c's views in the problem's frames, at an estimate.
std::vector<PosedView> posedViews(const CameraProblem& problem, const CameraEstimate& estimate,
                                  std::size_t c) {
  const Transform T_CiC0 = estimate.T_C0Ci[c].inverse();
  std::vector<PosedView> views;
  for (std::size_t f = 0; f < problem.frames.size(); ++f) {
    const int view = problem.frames[f].view[c];
    if (view >= 0) views.push_back({view, T_CiC0 * estimate.T_C0F[f]});
  }
  return views;
}

}  // namespace

std::vector<CornerPlace> cornersBeyond(const CameraProblem& problem, const CameraEstimate& estimate,
                                       double angle_rad) {
  std::vector<CornerPlace> places;
  for (std::size_t c = 0; c < problem.corners.size(); ++c) {
    if (!endsAtRightAngle(estimate.intrinsics[c])) continue;
    for (const PosedView& posed : posedViews(problem, estimate, c)) {
      for (const int k : beyondAngle(problem.corners[c].view(posed.view), posed.T_CF, angle_rad)) {
        places.push_back({c, posed.view, k});
      }
    }
  }
  return places;
}

std::vector<CornerPlace> misplacedCorners(const AprilGrid& target, const CameraProblem& problem,
                                          const CameraEstimate& estimate) {
  std::vector<CornerPlace> places;
  for (std::size_t c = 0; c < problem.corners.size(); ++c) {
    const Intrinsics& lens = estimate.intrinsics[c];
    for (const PosedView& posed : posedViews(problem, estimate, c)) {
      const PackedView view = problem.corners[c].view(posed.view);
      // The tags are looked through only where something is wrong.
      if (falseCorners(lens, view, posed.T_CF).empty()) continue;
      for (const MisplacedTag& tag : findMisplacedTags(target, lens, view, posed.T_CF)) {
        for (const int k : cornersOfTag(view, tag.tag)) places.push_back({c, posed.view, k});
      }
    }
  }
  return places;
}

std::size_t rejectCorners(const CameraProblem& problem, const CameraEstimate& estimate,
                          const CameraStageOptions& options, std::vector<PackedCorners>& corners) {
  std::size_t count = 0;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const Intrinsics& lens = estimate.intrinsics[c];
    const std::vector<PosedView> views = posedViews(problem, estimate, c);
    if (options.filter == CornerFilter::kSigma) {
      count += rejectAboveSigma(corners[c], lens, views, options.filter_sigmas);
    } else if (options.filter == CornerFilter::kKalibr) {
      // Each view by its own pose, refined alone: the joint solution is only where that starts.
      count += rejectLikeKalibr(corners[c], lens, views, problem.threads);
    }
  }
  return count;
}

void keepFrames(const std::vector<int>& keep, CameraProblem& problem, CameraEstimate& estimate) {
  std::vector<Frame> frames;
  std::vector<double> weights;
  std::vector<Transform> poses;
  for (const int i : keep) {
    frames.push_back(problem.frames[i]);
    poses.push_back(estimate.T_C0F[i]);
    if (!problem.weights.empty()) weights.push_back(problem.weights[i]);
  }
  problem.frames = std::move(frames);
  problem.weights = std::move(weights);
  estimate.T_C0F = std::move(poses);
}

std::vector<int> framesWithCorners(const CameraProblem& problem) {
  std::vector<int> keep;
  for (int f = 0; f < problem.frameCount(); ++f) {
    const Frame& frame = problem.frames[f];
    double most = 0;
    for (std::size_t c = 0; c < frame.view.size(); ++c) {
      if (frame.view[c] < 0) continue;
      most = std::max(most, problem.corners[c].view(frame.view[c]).used());
    }
    if (most >= kMinUsedCorners) keep.push_back(f);
  }
  return keep;
}

void dropBareFrames(CameraProblem& problem, CameraEstimate& estimate) {
  const std::vector<int> keep = framesWithCorners(problem);
  if (static_cast<int>(keep.size()) < problem.frameCount()) keepFrames(keep, problem, estimate);
}

}  // namespace plumbline
