// SPDX-License-Identifier: BSD-3-Clause
// Which corners and frames a solution is made of.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "calibrator/base/parallel.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/batch/camera/stage.h"
#include "calibrator/batch/camera/view_terms.h"
#include "calibrator/information/view_selection.h"
#include "calibrator/initialise/view_screening.h"

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

constexpr double kWorstView = 3;  // times the median RMSE

std::vector<RigView> rigViews(const CameraProblem& problem, const CameraEstimate& estimate) {
  std::vector<RigView> views;
  for (std::size_t f = 0; f < problem.frames.size(); ++f) {
    RigView rig;
    rig.T_C0F = estimate.T_C0F[f];
    for (std::size_t c = 0; c < problem.corners.size(); ++c) {
      const int view = problem.frames[f].view[c];
      rig.views.push_back(view >= 0 ? problem.corners[c].view(view) : PackedView{});
    }
    views.push_back(std::move(rig));
  }
  return views;
}

/// Frames of which none leaves far more error than the others.
std::vector<int> fittingFrames(const std::vector<ViewTerms>& terms) {
  std::vector<double> rmse;
  for (const ViewTerms& view : terms) {
    if (view.corners > 0) rmse.push_back(std::sqrt(view.squared_px / view.corners));
  }
  std::vector<int> fitting;
  if (rmse.empty()) return fitting;
  // Of errors without the loss, in which gross ones show.
  const double most = kWorstView * median(rmse);
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (terms[i].corners == 0) continue;
    const bool fits = std::sqrt(terms[i].squared_px / terms[i].corners) <= most;
    if (fits) fitting.push_back(static_cast<int>(i));
  }
  return fitting;
}

/// Takes from `left` the view with which E is least.
int takeBest(const PredictedError& error, const std::vector<ViewTerms>& terms,
             std::vector<int>& left) {
  auto best = left.begin();
  double least = std::numeric_limits<double>::infinity();
  for (auto i = left.begin(); i != left.end(); ++i) {
    // A value that is no number never counts as less: such a view is taken last.
    const double E = error.valueWith(terms[*i]);
    if (E < least) best = i;
    least = std::min(least, E);
  }
  const int taken = *best;
  left.erase(best);
  return taken;
}

std::vector<int> selectByError(const CameraProblem& problem, const CameraEstimate& estimate,
                               const ViewSelectionOptions& options) {
  const std::vector<RigView> views = rigViews(problem, estimate);
  std::vector<int> all(views.size());
  std::iota(all.begin(), all.end(), 0);
  const auto model =
      errorModel(views, estimate, problem.gram.cauchy_px, LaterUseKind::kSeen, problem.threads);
  // Frames that do not determine the cameras cannot be told apart by what they do for them.
  if (!model) return all;
  // Without cell weights: those are of later use, and make no measurement better.
  const std::vector<ViewTerms> terms = parallelMap(
      views.size(), problem.threads, [&](std::size_t i) { return model->maker.seen(views[i]); });
  std::vector<int> left = fittingFrames(terms);
  if (left.empty()) return all;
  std::vector<ViewTerms> fitting;
  for (const int i : left) fitting.push_back(terms[i]);
  // Of the fitting frames alone: gross errors of one would pass for misfit of the lens.
  const ErrorComponents components = guarded(errorComponents(fitting));
  PredictedError error(model->use, components);
  std::vector<int> kept;
  while (!left.empty()) {
    kept.push_back(takeBest(error, terms, left));
    error.add(terms[kept.back()]);
    // Before views tell b from tau, E stands on an even split of the misfit that is assumed.
    const bool enough =
        components.told_apart && static_cast<int>(kept.size()) >= options.least_views;
    if (enough && relativeExcess(error.value(), components) <= options.stop_excess) break;
  }
  // As keepFrames() takes them: the frames stay in the order of time, of which blocks are made
  // later.
  std::sort(kept.begin(), kept.end());
  return kept;
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

std::vector<int> selectFrames(const CameraProblem& problem, const CameraEstimate& estimate,
                              const ViewSelectionOptions& options) {
  if (options.criterion == ViewCriterion::kPredictedError) {
    return selectByError(problem, estimate, options);
  }
  // Bits of corners that err by pixel_sigma: the threshold counts under the stated noise.
  return selectViews(frameInformation(problem, estimate), options.threshold_bits, options.seed);
}

}  // namespace plumbline
