// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/base/frames.h"
#include "calibrator/residuals/packed_corners.h"

namespace plumbline {

/// Pose of the target in a camera from one view of known intrinsics: homography between the
/// target's plane and the normalised image (linear, centred), nearest rotation. `view` needs four
/// corners, not on a line; empty otherwise. Accurate to a few pixels: a start for refinement.
std::optional<Transform> planarPose(const Intrinsics& camera, const PackedView& view);

/// A pose and the RMS reprojection error it leaves [px].
struct RefinedPose {
  Transform pose;
  double rms_px = 0;
};

/// Minimises the reprojection error of one view over the pose T_CF of the target in that camera
/// (Gauss-Newton, at most `iterations`).
RefinedPose refineViewPose(const Intrinsics& camera, const PackedView& view, const Transform& T_CF,
                           int iterations);

/// Pose T_FC0 of a frame from all its views under known intrinsics and extrinsics: planarPose() of
/// the view with most corners, refined over all views. Empty where no view gives a start or the
/// refined error exceeds `max_rms_px`.
std::optional<Transform> framePose(const std::vector<CameraCalibration>& cameras,
                                   const std::vector<PackedCorners>& corners, const Frame& frame,
                                   double max_rms_px);

}  // namespace plumbline
