// SPDX-License-Identifier: BSD-3-Clause
// Velocities and accelerations of a spline are the derivatives of its poses, across segments too;
// a constant speed stays one; what is added later does not move what was.
#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/simulate/operator/rig_sensors.h"

namespace plumbline {
namespace {

SplineMotion wanderingMotion(int poses) {
  SplineMotion motion(0.1);
  for (int k = 0; k < poses; ++k) {
    const double s = k;
    motion.add({expSO3({0.3 * std::sin(0.7 * s), 0.4 * std::cos(0.9 * s), 0.5 * std::sin(s)}),
                {0.2 * std::sin(0.8 * s), 0.1 * s, 0.3 * std::cos(0.5 * s)}});
  }
  return motion;
}

TEST(SplineMotion, HasTheDerivativesOfItsPoses) {
  const SplineMotion motion = wanderingMotion(12);
  const double h = 1e-5;
  for (const double t : {0.013, 0.1, 0.25, 0.3, 0.555, 0.8}) {  // in segments and at their joints
    const MotionState m = motion.at(t), before = motion.at(t - h), after = motion.at(t + h);
    // Central differences: h^2 times a third derivative of up to 1e3 per s^3.
    EXPECT_LT((m.v_F - (after.T_FB.t - before.T_FB.t) / (2 * h)).norm(), 1e-6) << t;
    const Eigen::Vector3d turn = logSO3(before.T_FB.R.transpose() * after.T_FB.R) / (2 * h);
    EXPECT_LT((m.omega_B - turn).norm(), 1e-6) << t;
    // Across a joint the acceleration is continuous, its derivative is not: h times its jump.
    EXPECT_LT((m.a_F - (after.v_F - before.v_F) / (2 * h)).norm(), 0.02) << t;
    EXPECT_LT((m.alpha_B - (after.omega_B - before.omega_B) / (2 * h)).norm(), 0.02) << t;
  }
}

TEST(SplineMotion, KeepsAConstantSpeedAndTurn) {
  SplineMotion motion(0.2);
  const Eigen::Vector3d v(0.3, -0.1, 0.2), w(0.1, 0.7, -0.2);
  for (int k = 0; k < 8; ++k) motion.add({expSO3(w * (0.2 * k)), Eigen::Vector3d(v * (0.2 * k))});
  for (const double t : {0.0, 0.31, 0.99}) {
    const MotionState m = motion.at(t);
    EXPECT_LT((m.v_F - v).norm(), 1e-12);
    EXPECT_LT((m.omega_B - w).norm(), 1e-12);
    EXPECT_LT(m.a_F.norm() + m.alpha_B.norm(), 1e-10);
    EXPECT_LT((m.T_FB.t - v * (t + 0.2)).norm(), 1e-12) << "the second pose is that of t = 0";
  }
}

TEST(SplineMotion, IsNotMovedByWhatIsAddedLater) {
  const SplineMotion early = wanderingMotion(6), late = wanderingMotion(30);
  EXPECT_DOUBLE_EQ(early.knownUntilS(), 0.3);
  for (const double t : {0.0, 0.17, 0.299}) {
    EXPECT_EQ(early.at(t).a_F, late.at(t).a_F);
    EXPECT_EQ(early.at(t).omega_B, late.at(t).omega_B);
  }
  EXPECT_DOUBLE_EQ(SplineMotion(0.1).knownUntilS(), 0);
}

}  // namespace
}  // namespace plumbline
