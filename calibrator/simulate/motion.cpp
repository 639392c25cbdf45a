// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/motion.h"

#include <Eigen/Geometry>
#include <cmath>

namespace plumbline {

ScalarMotion SumOfSinusoids::at(double t_s) const {
  ScalarMotion m{mean, 0, 0};
  for (int i = 0; i < kTerms; ++i) {
    const double angle = omega[i] * t_s + phase[i];
    const double s = amplitude[i] * std::sin(angle);
    m.x += s;
    m.dx += amplitude[i] * omega[i] * std::cos(angle);
    m.ddx -= omega[i] * omega[i] * s;
  }
  return m;
}

RotationMotion rotationAbout(const Eigen::Vector3d& axis, const ScalarMotion& angle) {
  // A fixed axis is the same vector in either frame.
  return {Eigen::AngleAxisd(angle.x, axis).toRotationMatrix(), axis * angle.dx, axis * angle.ddx};
}

RotationMotion operator*(const RotationMotion& R_AB, const RotationMotion& R_BC) {
  // R_AC' dR_AC/dt gives w = w_BC + R_BC' w_AB, and as C turns
  //   d(R_BC' w_AB)/dt = R_BC' alpha_AB - w_BC x (R_BC' w_AB).
  const Eigen::Vector3d omega_C = R_BC.R.transpose() * R_AB.omega;  // of B against A, in C
  const Eigen::Vector3d alpha_C = R_BC.R.transpose() * R_AB.alpha;
  return {R_AB.R * R_BC.R, R_BC.omega + omega_C, R_BC.alpha + alpha_C - R_BC.omega.cross(omega_C)};
}

MotionState attached(const MotionState& body, const Transform& T_BX) {
  const Eigen::Vector3d& w = body.omega_B;
  const Eigen::Vector3d spin = w.cross(T_BX.t);
  return {.T_FB = body.T_FB * T_BX,
          .v_F = body.v_F + body.T_FB.R * spin,
          .a_F = body.a_F + body.T_FB.R * (body.alpha_B.cross(T_BX.t) + w.cross(spin)),
          // X is rigid to B: the same rate, in axes of its own.
          .omega_B = T_BX.R.transpose() * w,
          .alpha_B = T_BX.R.transpose() * body.alpha_B};
}

Transform lookingAt(const Eigen::Vector3d& p, const Eigen::Vector3d& aim) {
  const Eigen::Vector3d z = (aim - p).normalized();
  // Across z and F's y, so that the image stays level; y down follows.
  const Eigen::Vector3d x = Eigen::Vector3d(-z.z(), 0, z.x()).normalized();
  Eigen::Matrix3d R;
  R << x, z.cross(x), z;
  return {R, p};
}

}  // namespace plumbline
