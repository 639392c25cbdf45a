// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>

#include "calibrator/base/calibration.h"

namespace ceres {
class CostFunction;
class Manifold;
}  // namespace ceres

namespace plumbline {

/// A pose as Ceres' parameter block: translation, then quaternion in Eigen's order (x y z w).
using PoseBlock = std::array<double, 7>;
PoseBlock poseBlockFrom(const Transform& T);
Transform transformFrom(const PoseBlock& block);

/// The manifold of a PoseBlock; its tangent is (dt, da / 2) of Transform's tangent (dt, da). The
/// caller owns it.
std::unique_ptr<ceres::Manifold> makePoseManifold();

/// One measured corner: p_F = (x, y, 0) [m] in the target's frame, uv [px].
struct CornerMeasurement {
  Eigen::Vector2d p_F;
  Eigen::Vector2d uv;
};

/// Reprojection of one corner for free-form problems in Ceres, differentiated automatically:
///   e = h(T_C0Ci^-1 T_FC0^-1 p_F; k) - uv [px],
/// with the camera model's own function h (pinhole with radtan or equidistant distortion; others
/// throw std::invalid_argument) and the parameter blocks
///   0: intrinsics, Intrinsics::stacked() of `camera`'s model;  1: T_C0Ci;  2: T_FC0 (7 each).
/// Evaluation fails, and Ceres rejects the step, where the model does not project the corner.
/// For whole recordings use viewGram: this costs about 30 times as much.
std::unique_ptr<ceres::CostFunction> makeReprojectionCost(const Intrinsics& camera,
                                                          const CornerMeasurement& corner);

/// The same through the IMU: e = h(T_C0Ci^-1 T_SC0^-1 T_FS^-1 p_F; k) - uv, parameter blocks
///   0: intrinsics;  1: T_C0Ci;  2: T_SC0;  3: T_FS.
std::unique_ptr<ceres::CostFunction> makeImuReprojectionCost(const Intrinsics& camera,
                                                             const CornerMeasurement& corner);

}  // namespace plumbline
