// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "calibrator/residuals/packed_corners.h"

namespace plumbline {

/// How the corners of a view are weighted. Errors are taken in units of pixel_sigma by the caller's
/// scaling: everything here is in pixels.
struct GramOptions {
  /// Scale c of the Cauchy loss c^2 log(1 + |e|^2 / c^2) [px]; 0: squared error. Otherwise >= 1e-3.
  double cauchy_px = 0;
  /// With a loss: how much of the curvature along e its second derivative may take away, in
  /// [0, 2]. 0 is iteratively re-weighted least squares (H sums rho' J^T J); above, H sums
  ///   rho' J^T (I - beta n n^T) J,   n = e/|e|,   beta = min(2 s / (1 + s), triggs_clamp),
  /// s = |e|^2/c^2, after Triggs et al., "Bundle adjustment: a modern synthesis", sec. 4.3. The
  /// gradient b is exact in any case. Up to 1, H stays positive semi-definite; at 2 it is the whole
  /// second derivative of the loss, which near the minimum converges like Newton's method, but far
  /// from it is not definite. EuRoC stereo, c = 1.5 px, from published intrinsics: 33 iterations at
  /// 0, 25 at 0.5, 68 at 0.7; three at 0 and then all at 2: 11.
  double triggs_clamp = 0.7;
};

/// Cost [px^2] of a corner that cannot be projected (depth not above 1e-9 m,
/// parameters that are not finite) or misses by more than 1e5 px; such a corner has no gradient and
/// no loss is applied. It makes a step that puts the target behind the camera cost so much that it
/// is rejected, where a NaN would go through comparisons. The fold of the distortion is not checked
/// here: it moves with the parameters, and a cost that jumps there would mislead the solver.
inline constexpr double kInvalidSquaredError = 1e10;

/// Gauss-Newton terms of one view in the pose of the target in that camera.
///
/// With e = projected - measured [px] and the twist x = (rho [m], phi [rad]) in the camera frame,
/// p_C' = p_C + rho + phi x p_C, J = de/dx:  H = sum w J^T J,  b = sum w J^T e.
/// (Chain to the tangents of Transforms with the matrices A below.) With a loss, see GramOptions.
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

/// ViewGram with the terms s of the board's shape (base/april_grid.h): p_C' = p_C + R_CF B s.
struct TargetViewGram : ViewGram {
  Eigen::Matrix<double, 6, kTargetTerms> H_pose_s;
  Eigen::Matrix<double, Eigen::Dynamic, kTargetTerms, 0, kMaxIntrinsics, kTargetTerms> H_k_s;
  TargetCovariance H_s;
  TargetTerms b_s;
};

/// The functions of a TargetBasis at the corners of a view, padded as they are.
struct TargetColumns {
  const double* function[TargetBasis::kFunctions];
};

/// The versions of the kernels in one portable build. They agree to rounding.
enum class InstructionSet {
  kBaseline,  ///< what every machine of the platform has (SSE2 on x86-64)
  kAvx2,      ///< AVX2 with fused multiply-add
};

/// Whether this machine can run that version.
bool isAvailable(InstructionSet set);

/// The fastest available version.
InstructionSet bestInstructionSet();

/// Terms in the pose only (camera-IMU stage, pose refinement). Only tests and benchmarks choose the
/// version; to call an unavailable one is a bug.
PoseGram poseGram(const Intrinsics& camera, const Transform& T_CF, const PackedView& view,
                  const GramOptions& options = {}, InstructionSet set = bestInstructionSet());

/// Terms in pose and intrinsics (camera stage).
ViewGram viewGram(const Intrinsics& camera, const Transform& T_CF, const PackedView& view,
                  const GramOptions& options = {}, InstructionSet set = bestInstructionSet());

/// Terms in pose, intrinsics and the board's shape, about the places that the view states.
TargetViewGram targetViewGram(const Intrinsics& camera, const Transform& T_CF,
                              const PackedView& view, const TargetColumns& target,
                              const GramOptions& options = {},
                              InstructionSet set = bestInstructionSet());

/// cost alone: what a rejected step needs.
double viewCost(const Intrinsics& camera, const Transform& T_CF, const PackedView& view,
                const GramOptions& options = {}, InstructionSet set = bestInstructionSet());

// Matrices A (6x6) with x = A d to first order, from the tangent d = (dt, da) of a Transform (see
// there) to the twist x = (rho, phi) of a target pose T_CiF in camera i, for which
//   p_Ci' = p_Ci + rho + phi x p_Ci        (frame Ci, metres and radians),
// the derivative that poseGram and viewGram take. Terms chain as H <- A^T H A, b <- A^T b.

/// Adjoint of T_AB: x_A = Ad x_B for twists, phi_A = R phi_B, rho_A = R rho_B + t x phi_A.
Matrix6d adjoint(const Transform& T_AB);

/// The twist of T itself: x = A d for T <- boxplus(T, d). With T = T_CF:
/// rho = dt + t x da, phi = da.
Matrix6d twistFromTangent(const Transform& T);

/// T after the twist x on its left: p' = Exp(phi) p + rho, to first order p + rho + phi x p.
/// Orthonormal.
Transform twisted(const Transform& T, const Vector6d& x);

/// Derivatives of T_CiF = T_C0Ci^-1 * T_SC0^-1 * T_FS^-1 (camera-IMU calibration).
struct CameraImuChain {
  Transform T_CiF;
  Matrix6d A_FS;    ///< in the tangent of T_FS
  Matrix6d A_SC0;   ///< in the tangent of T_SC0
  Matrix6d A_C0Ci;  ///< in the tangent of T_C0Ci
};
CameraImuChain cameraImuChain(const Transform& T_FS, const Transform& T_SC0,
                              const Transform& T_C0Ci);

}  // namespace plumbline
