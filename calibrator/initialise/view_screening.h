// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/base/results/screening.h"
#include "calibrator/base/session.h"
#include "calibrator/base/transform.h"
#include "calibrator/residuals/packed_corners.h"

namespace plumbline {

/// Views with the same corners to the last digit as the view before them, while another camera's
/// view changed or the gyroscope turned by more than 5 mrad: the image was delivered twice. Per
/// camera, indices into its views. Without a gyroscope and a second camera none is found, for a rig
/// at rest may see the same twice where corners have no noise.
std::vector<std::vector<int>> repeatedViews(const Session& session);

/// Tags of one view that stand by more than half a tag's side off where the pose puts their id, and
/// in the place of another (to a quarter of a side). None where those off their place are 40 % of
/// the view's tags and more: then the pose is wrong. Stamp and camera are left to the caller.
std::vector<MisplacedTag> findMisplacedTags(const AprilGrid& target, const Intrinsics& camera,
                                            const PackedView& view, const Transform& T_CF);

/// Positions within a view of the corners of a tag.
std::vector<int> cornersOfTag(const PackedView& view, int tag);

/// The angle to the optical axis beyond which corners are left out [rad]: at 90 degrees a pinhole's
/// plane coordinates end, and a corner whose noise puts it beyond would stall any solver.
inline constexpr double kGrazing = 89 * kDegree;

/// Whether corners at 90 degrees from the optical axis are beyond what the model can project.
inline bool endsAtRightAngle(const Intrinsics& camera) {
  return camera.projection_model == ProjectionModel::kPinhole;
}

/// Positions of used corners that the pose puts beyond an angle from the optical axis.
std::vector<int> beyondAngle(const PackedView& view, const Transform& T_CF, double angle_rad);

/// Positions of used corners that are off the pose's prediction by more than 3 px and 8 times their
/// view's standard deviation (robust, per axis).
std::vector<int> falseCorners(const Intrinsics& camera, const PackedView& view,
                              const Transform& T_CF);

}  // namespace plumbline
