// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/transform.h"
#include "calibrator/residuals/packed_corners.h"
#include "calibrator/residuals/view_gram.h"

namespace plumbline {

/// Pose T_CF of the target in a camera from one view, linear: the homography H that minimises
/// |ray x H X| over rays of unit length (so that the rim of a fisheye weighs no more than its
/// centre), then the nearest rotation. Four corners, not on a line; empty otherwise. A start for
/// refinePose().
std::optional<Transform> homographyPose(const Intrinsics& camera, const PackedView& view);

/// The other pose that explains a small, distant target about as well: its normal mirrored at the
/// line of sight to `centre` (target's frame).
Transform mirroredPose(const Transform& T_CF, const Eigen::Vector2d& centre);

/// One camera's share in a frame; T_CiC0 is known.
struct FrameView {
  const Intrinsics* camera = nullptr;
  PackedView view;
  Transform T_CiC0;
};

/// RMS over the corners of the width of the image that they are in [px], for errors of a frame in
/// shares of it; 0 without corners.
double rmsWidth(const std::vector<FrameView>& views);

struct PoseRefinement {
  Transform T_C0F;
  double cost = 0;     ///< sum of rho(|e|^2) [px^2]
  double corners = 0;  ///< used ones
  bool converged = false;
  Matrix6d information = Matrix6d::Zero();  ///< under 1 px, in the left twist (rho, phi) of T_C0F

  /// sqrt(cost / corners) [px]: the RMS error, of which a loss lets gross errors take little.
  double errorPx() const;
};

/// PoseRefinement::errorPx() of a pose as it stands.
double errorPx(const std::vector<FrameView>& views, const Transform& T_C0F,
               const GramOptions& options);

struct PoseRefinementOptions {
  GramOptions gram{0, 0};
  int max_iterations = 10;
  /// Converged with the step that is shorter than this, in standard deviations of the pose under
  /// 1 px; it is still taken.
  double tolerance = 1e-2;

  /// Throws InputError for a negative number of steps or a tolerance that is not positive.
  void check() const;
};

/// Minimises the reprojection error of a frame's views over the pose of the target in camera 0
/// (minimise()). Checks the options.
PoseRefinement refinePose(const std::vector<FrameView>& views, const Transform& T_C0F,
                          const PoseRefinementOptions& options = {});

/// From nothing: homographyPose() of the view with most corners, refined over all views. Where that
/// leaves more than `good_px`, parts of the view are tried in place of the whole, for a stray
/// corner spoils a homography; where the view holds few corners, the mirrored pose is tried as
/// well. Empty where nothing gives a start.
std::optional<PoseRefinement> findPose(const std::vector<FrameView>& views, double good_px,
                                       const PoseRefinementOptions& options = {});

}  // namespace plumbline
