// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"

namespace plumbline {

/// Most intrinsic parameters any model has (projection and distortion together).
inline constexpr int kMaxIntrinsics = 12;
/// 2 x K, K <= kMaxIntrinsics, without heap storage.
using IntrinsicsJacobian = Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, kMaxIntrinsics>;

/// h(p_C; k) with its derivatives.
struct Projection {
  Eigen::Vector2d uv;                   ///< [px]
  Eigen::Matrix<double, 2, 3> J_point;  ///< d uv / d p_C [px/m]
  IntrinsicsJacobian J_intrinsics;      ///< d uv / d stacked()
};

/// Projects a point of the camera frame [m] to pixels. Empty where the model does not define it:
/// behind the camera (wide-angle models: beyond their own limit), or beyond the radius at which the
/// distortion stops growing (folding back). Every model that Kalibr writes projects; throws
/// InputError for another pair of models, or a wrong number of parameters.
std::optional<Eigen::Vector2d> project(const Intrinsics& camera, const Eigen::Vector3d& p_C);

/// The same of many points, one after the other.
std::vector<std::optional<Eigen::Vector2d>> project(const Intrinsics& camera,
                                                    std::span<const Eigen::Vector3d> p_C);

/// project() with analytic Jacobians.
std::optional<Projection> projectWithJacobians(const Intrinsics& camera,
                                               const Eigen::Vector3d& p_C);

/// The same beyond the fold of the distortion as well: by the rule of the Gram kernels
/// (residuals/view_gram.h), for sums that must have the corners that theirs have.
std::optional<Projection> projectBeyondFold(const Intrinsics& camera, const Eigen::Vector3d& p_C);

/// Pixels per radian along u on the optical axis: d u / d X of project() at (0, 0, 1). It is fu for
/// pinholes (but fov) and eucm, fu / (1 + xi) for omni and ds, whose fu alone is no scale of the
/// image. fu where the axis itself is not projected.
double pixelsPerRadian(const Intrinsics& camera);

/// The unit-length ray of a pixel, inverse of project() to 1e-12 in normalised coordinates
/// (Newton). Empty where it does not converge or lies outside the model's domain.
std::optional<Eigen::Vector3d> unproject(const Intrinsics& camera, const Eigen::Vector2d& uv);

}  // namespace plumbline
