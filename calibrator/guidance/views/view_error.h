// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "calibrator/batch/camera/view_terms.h"
#include "calibrator/guidance/frame_corners.h"
#include "calibrator/guidance/views/view_gain.h"
#include "calibrator/information/predicted_error.h"

namespace plumbline {

/// A view whose RMSE is more than so many times the median of the others' does not fit them.
inline constexpr double kWorstView = 3;

/// Of the regions of an image (CornerCells), this share must have been seen before frames seen can
/// stand for later use (docs/counterfactuals.md, "In the guide").
inline constexpr double kLeastCoverage = 0.9;

/// With so many views, how many more until the estimate is made anew: that costs the more the more
/// views there are, and one view changes the estimate the less.
int viewsUntilRefresh(int views);

/// Predicts, while frames come, by how much the cameras as they are estimated will miss where they
/// are used (information/predicted_error.h), and what a further view would change.
///
/// The model is made anew at an estimate by refresh(): every frame kept and those that stand for
/// later use get the pose that their corners want there. Between refreshes views are added to it.
class ViewErrorTracker {
 public:
  ViewErrorTracker(const AprilGrid& target, const ViewErrorOptions& options);

  /// A frame with a plausible pose, whatever becomes of it.
  void see(const FrameCorners& corners, const Transform& T_FC0);
  /// A view of the estimate, corners per camera.
  void keep(const FrameCorners& corners, const Transform& T_FC0);
  /// Whether what came since the last refresh() calls for another: every view kept up to 8, then
  /// every 2nd, 4th, 6th and 10th (from 12, 20, 32 on); or 25 frames seen, where those are the
  /// later use.
  bool isDue() const;
  /// `cameras`: calibrations of the estimate's cameras, whose candidateViews() are the later use
  /// kImage.
  void refresh(const CameraEstimate& estimate, const std::vector<CameraCalibration>& cameras,
               int threads);

  /// Whether there is a prediction: frames and views kept determine the cameras.
  bool isKnown() const { return model_.has_value(); }
  /// All below only where it is known.
  double predicted() const { return error_->value(); }  ///< E of the views kept [px^2]
  double excess() const { return relativeExcess(predicted(), components_); }
  int keptCount() const { return static_cast<int>(kept_.size()); }
  const ErrorComponents& components() const { return components_; }
  /// Share of the regions of an image, of the camera with the least, in which later use has
  /// corners; of kImage 1, as it is made to cover the image.
  double coverage() const { return coverage_; }

  /// E with a frame that was seen [px^2].
  double seenWith(const FrameCorners& corners, const Transform& T_FC0) const;
  /// E with each of the views that nobody has taken [px^2]; NaN where no camera sees enough. The
  /// result does not depend on `threads`.
  std::vector<double> predictedWith(const std::vector<Transform>& T_FC0, int threads) const;
  /// Whether a frame that took part in `estimate` leaves there at most three times the median RMSE
  /// of the views kept: one photograph of several px would inflate all components. Before it takes
  /// part that cannot be told: a young estimate fits no view of another part of the image.
  bool fits(const CameraEstimate& estimate, const FrameCorners& corners,
            const Transform& T_FC0) const;

 private:
  struct Held : PackedFrame {
    Transform T_C0F;
    RigView view() const;
  };
  Held hold(const FrameCorners& corners, const Transform& T_FC0) const;
  void pose(Held& frame) const;
  static double rmsePx(const CameraEstimate& cameras, const Held& frame);
  std::vector<Held> imagined(const std::vector<Transform>& T_FC0) const;

  AprilGrid target_;
  ViewErrorOptions options_;
  std::vector<Held> seen_, kept_;
  int seen_count_ = 0, seen_stride_ = 1;
  int kept_at_refresh_ = 0, seen_at_refresh_ = 0;
  CameraEstimate cameras_;
  double median_px_ = 0;  // RMSE of the views kept, at least kNoiseFloorPx
  std::vector<VisibleTags> visible_;
  std::optional<ErrorModel> model_;
  std::optional<PredictedError> error_;
  ErrorComponents components_;
  double coverage_ = 1;
};

}  // namespace plumbline
