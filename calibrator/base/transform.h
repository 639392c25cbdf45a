// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
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

}  // namespace plumbline
