// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>

#include "calibrator/base/transform.h"

namespace plumbline {

/// A scalar and its first two time derivatives.
struct ScalarMotion {
  double x = 0, dx = 0, ddx = 0;
};

/// x(t) = mean + sum_i a_i sin(w_i t + phi_i): smooth to any order, bounded by mean +- sum a_i.
struct SumOfSinusoids {
  static constexpr int kTerms = 3;

  double mean = 0;
  std::array<double, kTerms> amplitude{};
  std::array<double, kTerms> omega{};  ///< [rad/s]
  std::array<double, kTerms> phase{};  ///< [rad]

  ScalarMotion at(double t_s) const;
};

/// A rotation R_AB that moves, with rates in the frame B: dR/dt = R [omega]x, alpha = d omega/dt.
struct RotationMotion {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d omega = Eigen::Vector3d::Zero();  ///< [rad/s]
  Eigen::Vector3d alpha = Eigen::Vector3d::Zero();  ///< [rad/s^2]
};

/// Rotation about a fixed unit axis by a moving angle [rad].
RotationMotion rotationAbout(const Eigen::Vector3d& axis, const ScalarMotion& angle);

/// R_AC = R_AB R_BC, where both move.
RotationMotion operator*(const RotationMotion& R_AB, const RotationMotion& R_BC);

/// Pose, velocity and acceleration of a frame B that moves in the target's frame F.
struct MotionState {
  Transform T_FB;
  Eigen::Vector3d v_F = Eigen::Vector3d::Zero();      ///< of B's origin, in F [m/s]
  Eigen::Vector3d a_F = Eigen::Vector3d::Zero();      ///< of B's origin, in F [m/s^2]
  Eigen::Vector3d omega_B = Eigen::Vector3d::Zero();  ///< of B against F, in B [rad/s]
  Eigen::Vector3d alpha_B = Eigen::Vector3d::Zero();  ///< d omega_B / dt [rad/s^2]
};

/// The motion of a frame X that is fixed to B at T_BX:
/// v_X = v_B + R_FB (w x t),  a_X = a_B + R_FB (alpha x t + w x (w x t)).
MotionState attached(const MotionState& body, const Transform& T_BX);

/// Orientation of a camera (x right, y down, z forward) that faces the target squarely.
inline Eigen::Matrix3d facingTarget() { return Eigen::Vector3d(1, -1, -1).asDiagonal(); }

/// T_FC of a camera at p that looks at `aim`, its x axis in the x-z plane of F. The line of sight
/// is not along y of F.
Transform lookingAt(const Eigen::Vector3d& p, const Eigen::Vector3d& aim);

}  // namespace plumbline
