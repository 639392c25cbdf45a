// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "calibrator/residuals/packed_corners.h"

namespace plumbline {

/// How the corners of a view are weighted. Errors are taken in units of pixel_sigma by the caller's
/// scaling: everything here is in pixels.
struct GramOptions {
  double cauchy_px =
      0;  ///< scale c of the Cauchy loss c^2 log(1 + |e|^2 / c^2) [px]; 0: squared error
};

/// Gauss-Newton terms of one view in the pose of the target in that camera.
///
/// With e = projected - measured [px] and the twist x = (rho [m], phi [rad]) in the camera frame,
/// p_C' = p_C + rho + phi x p_C, J = de/dx:  H = sum w J^T J,  b = sum w J^T e.
/// (Chain to the tangent of a Transform with poseFromTwist in residuals/tangent.h.)
struct PoseGram {
  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  double squared_error = 0;  ///< sum |e|^2 over corners with weight, whatever the loss [px^2]
  double cost = 0;           ///< sum of rho(|e|^2) [px^2]; equals squared_error without loss
};

/// PoseGram with the camera's intrinsics k (K of them, order of Intrinsics::stacked()).
struct ViewGram : PoseGram {
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMaxIntrinsics> H_pose_k;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxIntrinsics, kMaxIntrinsics> H_k;
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxIntrinsics, 1> b_k;
};

/// Terms in the pose only (camera-IMU stage, pose refinement).
PoseGram poseGram(const Intrinsics& camera, const Transform& T_CF, const PackedView& view,
                  const GramOptions& options = {});

/// Terms in pose and intrinsics (camera stage).
ViewGram viewGram(const Intrinsics& camera, const Transform& T_CF, const PackedView& view,
                  const GramOptions& options = {});

/// cost alone: what a rejected step needs.
double viewCost(const Intrinsics& camera, const Transform& T_CF, const PackedView& view,
                const GramOptions& options = {});

}  // namespace plumbline
