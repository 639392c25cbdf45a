// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <numbers>

namespace plumbline {

inline constexpr double kDegree = std::numbers::pi / 180;   ///< [rad]
inline constexpr double kDegrees = 180 / std::numbers::pi;  ///< per radian

/// [w]x, so that skew(w) * p == w.cross(p).
Eigen::Matrix3d skew(const Eigen::Vector3d& w);

/// Exp: rotation vector [rad] to rotation matrix (Rodrigues). Any norm; series below 1e-4 rad.
Eigen::Matrix3d expSO3(const Eigen::Vector3d& w);

/// Log: rotation matrix to rotation vector [rad], norm in [0, pi]. Inverse of expSO3 below pi.
Eigen::Vector3d logSO3(const Eigen::Matrix3d& R);

/// Right Jacobian: Exp(w + d) = Exp(w) Exp(Jr(w) d) to first order in d.
Eigen::Matrix3d rightJacobianSO3(const Eigen::Vector3d& w);

/// Left Jacobian: Exp(w + d) = Exp(Jl(w) d) Exp(w) to first order in d; Jl(w) = Jr(-w).
Eigen::Matrix3d leftJacobianSO3(const Eigen::Vector3d& w);

/// Inverse of the right Jacobian: Log(Exp(w) Exp(d)) = w + Jr^-1(w) d. Norm of w below 2 pi.
Eigen::Matrix3d inverseRightJacobianSO3(const Eigen::Vector3d& w);

/// Inverse of the left Jacobian: Log(Exp(d) Exp(w)) = w + Jl^-1(w) d. Norm of w below 2 pi.
Eigen::Matrix3d inverseLeftJacobianSO3(const Eigen::Vector3d& w);

/// The rotation by the least angle that turns the direction of `from` into that of `to` (neither
/// zero): about from x to. For opposite directions one of those by pi.
Eigen::Matrix3d shortestTurn(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// The rotation nearest to R in the Frobenius norm (R = U S V^T, gives U diag(1,1,+-1) V^T).
Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& R);

}  // namespace plumbline
