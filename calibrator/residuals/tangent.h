// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibrator/base/transform.h"

namespace plumbline {

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
