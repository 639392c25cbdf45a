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

struct PoseRefinement {
  Transform T_C0F;
  double cost = 0;           ///< sum of rho(|e|^2) [px^2]
  double squared_error = 0;  ///< sum |e|^2 of used corners [px^2]
  double corners = 0;        ///< used ones
  bool converged = false;

  double rmsPx() const;
};

struct PoseRefinementOptions {
  GramOptions gram;
  int max_iterations = 10;
  /// Converged where the remaining step is shorter than this, in standard deviations of the pose
  /// under 1 px.
  double tolerance = 1e-3;
};

/// Minimises the reprojection error of a frame's views over the pose of the target in camera 0
/// (Levenberg-Marquardt).
PoseRefinement refinePose(const std::vector<FrameView>& views, const Transform& T_C0F,
                          const PoseRefinementOptions& options = {});

/// From nothing: homographyPose() of the view with most corners, refined over all views; where that
/// view holds few corners its mirrored pose is tried as well. Empty where no view gives a start.
std::optional<PoseRefinement> findPose(const std::vector<FrameView>& views,
                                       const PoseRefinementOptions& options = {});

}  // namespace plumbline
