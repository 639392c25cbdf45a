// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/views/view_error.h"

#include <algorithm>
#include <bitset>
#include <cassert>
#include <limits>
#include <utility>

#include "calibrator/base/parallel.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/guidance/views/candidate_views.h"
#include "calibrator/initialise/camera_poses.h"
#include "calibrator/initialise/camera_start.h"

namespace plumbline {
namespace {

// Poses start where another estimate had them, and serve a prediction to first order alone.
constexpr double kPoseTolerance = 1e-3;  // standard deviations
constexpr int kPoseIterations = 10;
constexpr int kSeenUntilRefresh = 25;

/// See ViewErrorTracker::coverage().
double leastCoverage(const std::vector<RigView>& frames, const CameraEstimate& cameras) {
  double least = 1;
  for (std::size_t c = 0; c < cameras.intrinsics.size(); ++c) {
    std::bitset<CornerCells::kCount> seen;
    for (const RigView& frame : frames) {
      const PackedView& view = frame.views[c];
      for (int k = 0; k < view.count; ++k) {
        const int cell =
            CornerCells::cellOf(view.u[k], view.v[k], cameras.intrinsics[c].resolution);
        seen.set(static_cast<std::size_t>(cell));
      }
    }
    least = std::min(least, static_cast<double>(seen.count()) / CornerCells::kCount);
  }
  return least;
}

}  // namespace

int viewsUntilRefresh(int views) {
  if (views < 8) return 1;
  if (views < 12) return 2;
  if (views < 20) return 4;
  return views < 32 ? 6 : 10;
}

ViewErrorTracker::ViewErrorTracker(const AprilGrid& target, const ViewErrorOptions& options)
    : target_(target), options_(options) {
  options.check();
}

RigView ViewErrorTracker::Held::view() const {
  RigView rig;
  rig.T_C0F = T_C0F;
  for (const PackedCorners& camera : corners) rig.views.push_back(camera.view(0));
  return rig;
}

ViewErrorTracker::Held ViewErrorTracker::hold(const FrameCorners& corners,
                                              const Transform& T_FC0) const {
  return {{target_, corners}, T_FC0.inverse()};
}

void ViewErrorTracker::see(const FrameCorners& corners, const Transform& T_FC0) {
  if (seen_count_++ % seen_stride_ != 0) return;
  seen_.push_back(hold(corners, T_FC0));
  if (static_cast<int>(seen_.size()) <= options_.most_seen) return;
  // Every second one leaves: what remains is spread evenly over all that was seen.
  std::vector<Held> spread;
  for (std::size_t i = 0; i < seen_.size(); i += 2) spread.push_back(std::move(seen_[i]));
  seen_ = std::move(spread);
  seen_stride_ *= 2;
}

void ViewErrorTracker::keep(const FrameCorners& corners, const Transform& T_FC0) {
  kept_.push_back(hold(corners, T_FC0));
  // Until the next refresh by the model as it stands.
  if (error_) error_->add(model_->maker.seen(kept_.back().view()));
}

bool ViewErrorTracker::isDue() const {
  const int kept = static_cast<int>(kept_.size());
  const bool seen_more = options_.later_use == LaterUseKind::kSeen &&
                         seen_count_ - seen_at_refresh_ >= kSeenUntilRefresh;
  return seen_more || kept - kept_at_refresh_ >= viewsUntilRefresh(kept_at_refresh_);
}

void ViewErrorTracker::pose(Held& frame) const {
  const GramOptions gram{.cauchy_px = options_.cauchy_px};
  const PoseRefinementOptions options{gram, kPoseIterations, kPoseTolerance};
  frame.T_C0F = refinePose(frame.views(cameras_), frame.T_C0F, options).T_C0F;
}

// Without the loss: a gross error shall show.
double ViewErrorTracker::rmsePx(const CameraEstimate& cameras, const Held& frame) {
  return errorPx(frame.views(cameras), frame.T_C0F, {});
}

void ViewErrorTracker::refresh(const CameraEstimate& estimate,
                               const std::vector<CameraCalibration>& cameras, int threads) {
  cameras_ = estimate;
  cameras_.T_C0F.clear();
  kept_at_refresh_ = static_cast<int>(kept_.size());
  seen_at_refresh_ = seen_count_;
  // Made of the intrinsics, which have moved.
  visible_.clear();
  for (const Intrinsics& camera : cameras_.intrinsics) {
    visible_.emplace_back(camera, target_, VisibleTags::Limits());
  }
  error_.reset();
  std::vector<double> rmse;
  // Poses anew: they were found under the estimate of their time.
  for (Held& frame : kept_) {
    pose(frame);
    rmse.push_back(rmsePx(cameras_, frame));
  }
  std::vector<Held> made;
  const std::vector<Held>* use = &seen_;
  if (options_.later_use == LaterUseKind::kImage) {
    std::vector<Transform> T_FC0;
    for (const CandidateView& view : candidateViews(cameras, target_)) T_FC0.push_back(view.T_FC0);
    made = imagined(T_FC0);
    use = &made;
  } else {
    for (Held& frame : seen_) pose(frame);
  }
  std::vector<RigView> frames;
  for (const Held& frame : *use) frames.push_back(frame.view());
  if (options_.later_use == LaterUseKind::kSeen) coverage_ = leastCoverage(frames, cameras_);
  model_ = errorModel(frames, cameras_, options_.cauchy_px, options_.later_use, threads);
  // Later use that does not determine the cameras predicts nothing.
  if (!model_ || kept_.empty()) return model_.reset();
  // Of exact corners the median is rounding, of which good views may have three times as much.
  median_px_ = std::max(median(rmse), kNoiseFloorPx);
  std::vector<ViewTerms> terms, fitting;
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    terms.push_back(model_->maker.seen(kept_[i].view()));
    // Gross errors of a view would pass for misfit of the lens.
    if (rmse[i] <= kWorstView * median_px_) fitting.push_back(terms.back());
  }
  components_ = guarded(errorComponents(fitting));
  error_.emplace(model_->use, components_);
  // All of them: those that do not fit are in the estimate too, only the components go without.
  for (const ViewTerms& view : terms) error_->add(view);
}

/// The corners that would be seen there, exact; of cameras that would see too few, none.
std::vector<ViewErrorTracker::Held> ViewErrorTracker::imagined(
    const std::vector<Transform>& T_FC0) const {
  std::vector<Held> frames;
  for (const Transform& T : T_FC0) {
    const Transform T_C0F = T.inverse();
    FrameCorners seen;
    for (std::size_t c = 0; c < visible_.size(); ++c) {
      seen.push_back(visible_[c].corners(cameras_.T_C0Ci[c].inverse() * T_C0F));
      if (static_cast<int>(seen.back().size()) < options_.min_corners) seen.back().clear();
    }
    frames.push_back(hold(seen, T));
  }
  return frames;
}

double ViewErrorTracker::seenWith(const FrameCorners& corners, const Transform& T_FC0) const {
  assert(error_);
  // Terms under the model of the last refresh, as those of the views kept: only then do they add
  // up.
  const Held frame = hold(corners, T_FC0);
  return error_->valueWith(model_->maker.seen(frame.view()));
}

std::vector<double> ViewErrorTracker::predictedWith(const std::vector<Transform>& T_FC0,
                                                    int threads) const {
  assert(error_);
  std::vector<double> errors(T_FC0.size(), std::numeric_limits<double>::quiet_NaN());
  forChunks(static_cast<int>(T_FC0.size()), kViewChunk, threads, [&](const Chunk& chunk) {
    // Kept from view to view of a task.
    std::vector<PredictedCorners> memory;
    for (const VisibleTags& tags : visible_) memory.emplace_back(tags.cornerCount());
    for (auto i = static_cast<std::size_t>(chunk.begin); i < static_cast<std::size_t>(chunk.end);
         ++i) {
      RigView rig;
      rig.T_C0F = T_FC0[i].inverse();
      for (std::size_t c = 0; c < visible_.size(); ++c) {
        visible_[c].predict(cameras_.T_C0Ci[c].inverse() * rig.T_C0F, memory[c]);
        const PackedView view = memory[c].view();
        rig.views.push_back(view.count >= options_.min_corners ? view : PackedView{});
      }
      const ViewTerms terms = model_->maker.imagined(rig);
      // NaN is left where no camera would see enough.
      if (terms.corners > 0) errors[i] = error_->valueWith(terms);
    }
  });
  return errors;
}

bool ViewErrorTracker::fits(const CameraEstimate& estimate, const FrameCorners& corners,
                            const Transform& T_FC0) const {
  return rmsePx(estimate, hold(corners, T_FC0)) <= kWorstView * median_px_;
}

}  // namespace plumbline
