// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/time.h"

namespace plumbline {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// A rigid transform T_AB: p_A = T_AB * p_B = R_AB p_B + t_AB, with t_AB the origin of B in A [m].
///
/// Tangent space (every pose in this project): d = (dt, da), translation additive in the outer
/// frame A, orientation perturbed on the left in radians:
///   boxplus(T, d) = (Exp(da) R, t + dt),   so   dp_A = dt - [R p_B]x da.
struct Transform {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();

  Transform() = default;
  Transform(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation)
      : R(rotation), t(translation) {}
  /// `q` is normalised here.
  Transform(const Eigen::Quaterniond& q, const Eigen::Vector3d& translation)
      : R(q.normalized().toRotationMatrix()), t(translation) {}

  /// From a 4x4 homogeneous matrix; the rotation is projected on SO(3).
  static Transform fromMatrix(const Eigen::Matrix4d& T);
  Eigen::Matrix4d matrix() const;
  Eigen::Quaterniond quaternion() const { return Eigen::Quaterniond(R).normalized(); }

  Transform inverse() const { return {Eigen::Matrix3d(R.transpose()), -(R.transpose() * t)}; }
  Transform operator*(const Transform& o) const { return {Eigen::Matrix3d(R * o.R), R * o.t + t}; }
  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return R * p + t; }
};

/// T (+) d as defined at Transform; the rotation is renormalised, so that chains do not drift.
Transform boxplus(const Transform& T, const Vector6d& d);

/// The d with boxplus(from, d) == to: (t_to - t_from, Log(R_to R_from^T)).
Vector6d boxminus(const Transform& to, const Transform& from);

/// Angle of R [rad], in [0, pi].
double rotationAngle(const Eigen::Matrix3d& R);

/// A body's pose at one instant: p_W = q p_B + p. `q` is Hamilton, as it was read: not normalised,
/// for ov_eval's figures stand on unnormalised quaternions. transform() normalises.
struct StampedPose {
  TimeNs t = 0;
  Eigen::Vector3d p = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();

  Transform transform() const { return {q, p}; }
};

/// Poses in the order of their stamps (not descending; equal stamps may occur and are reported by
/// whoever pairs them).
struct Trajectory {
  std::string name;
  std::vector<StampedPose> poses;
  /// Whether the source had orientations (leica0 has none; then every q is the identity).
  bool has_orientation = true;
  /// Of each pose, tangent (dt, da) of Transform [m, rad]; empty, or one per pose.
  std::vector<Matrix6d> covariances;
};

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
