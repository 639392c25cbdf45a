// SPDX-License-Identifier: BSD-3-Clause
// A simulated person does what is asked for, as late, as slowly and as inexactly as skill says.
#include "calibrator/simulate/operator/simulated_operator.h"

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/base/lie.h"

namespace plumbline {
namespace {

constexpr double kSpacing = 0.1;

OperatorSkill exact() {
  OperatorSkill skill;
  skill.position_error_m = skill.angle_error_rad = 0;
  skill.tremor_m = skill.tremor_rad = 0;
  return skill;
}

Suggestion viewAt(const Eigen::Vector3d& p) {
  Suggestion s;
  s.id = 7;
  s.T_FC0 = {Eigen::Matrix3d(Eigen::Vector3d(1, -1, -1).asDiagonal()), p};
  return s;
}

SimulatedOperator person(const OperatorSkill& skill, std::uint64_t seed = 3) {
  return {skill, AprilGrid(), 1.0, kSpacing, seed};
}

TEST(SimulatedOperator, MovesWithinItsSpeedLimits) {
  const OperatorSkill skill = exact();
  SimulatedOperator p = person(skill);
  Transform last = p.next();
  double fastest = 0, fastest_turn = 0;
  for (int k = 0; k < 600; ++k) {
    const Transform now = p.next();
    const Vector6d step = boxminus(now, last);
    fastest = std::max(fastest, step.head<3>().norm() / kSpacing);
    fastest_turn = std::max(fastest_turn, step.tail<3>().norm() / kSpacing);
    last = now;
  }
  EXPECT_LE(fastest, skill.speed_m_s * (1 + 1e-9));
  EXPECT_LE(fastest_turn, skill.turn_rad_s * (1 + 1e-9));
  EXPECT_GT(fastest, 0.8 * skill.speed_m_s) << "and uses them";
}

TEST(SimulatedOperator, LooksAtTheBoardFromAllAround) {
  SimulatedOperator p = person(exact());
  const AprilGrid target;
  const Eigen::Vector3d centre(0.5 * target.width(), 0.5 * target.height(), 0);
  double left = 0, right = 0;
  for (int k = 0; k < 1200; ++k) {
    const Transform T = p.next();
    const Eigen::Vector3d seen = T.inverse() * centre;
    EXPECT_GT(seen.z(), 0.5) << "the board is in front";
    const double azimuth = std::atan2(T.t.x() - centre.x(), T.t.z());
    left = std::min(left, azimuth);
    right = std::max(right, azimuth);
  }
  EXPECT_LT(left, -0.3);
  EXPECT_GT(right, 0.3);
}

TEST(SimulatedOperator, GoesToASuggestedViewAfterTheReactionTime) {
  OperatorSkill skill = exact();
  skill.reaction_s = 1;
  SimulatedOperator shown = person(skill), alone = person(skill);
  shown.show(viewAt({0.2, 0.3, 1.1}), 0);
  for (int k = 0; k < 9; ++k) EXPECT_EQ(shown.next().t, alone.next().t) << "not noticed yet";
  for (int k = 0; k < 91; ++k) shown.next();
  const Transform reached = shown.next();
  EXPECT_LT((reached.t - Eigen::Vector3d(0.2, 0.3, 1.1)).norm(), 1e-3);
  EXPECT_LT(rotationAngle(reached.R * viewAt({}).T_FC0.R.transpose()), 1e-3);
}

TEST(SimulatedOperator, MeetsAViewInexactlyAndCorrectsItself) {
  OperatorSkill skill = exact();
  skill.position_error_m = 0.1;
  skill.correction_s = 4;
  double early = 0, late = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SimulatedOperator p = person(skill, seed);
    const Suggestion view = viewAt({0.3, 0.3, 1.3});
    p.show(view, 0);
    for (int k = 0; k < 40; ++k) p.next();
    early += (p.next().t - view.T_FC0.t).norm() / 20;
    for (int k = 0; k < 200; ++k) p.next();
    late += (p.next().t - view.T_FC0.t).norm() / 20;
  }
  EXPECT_GT(early, 0.03);
  EXPECT_LT(late, 0.2 * early);
}

TEST(SimulatedOperator, FollowsATrajectoryOnceTheGuideSaysGo) {
  Suggestion s = viewAt({0.2, 0.3, 1.2});
  for (int k = 0; k <= 50; ++k) s.path.push_back(viewAt({0.2 + 0.01 * k, 0.3, 1.2}).T_FC0);
  SimulatedOperator p = person(exact());
  p.show(s, 0);
  for (int k = 0; k < 80; ++k) p.next();
  EXPECT_LT((p.next().t - s.T_FC0.t).norm(), 2e-3) << "waits at its start";
  p.go(8);
  EXPECT_FALSE(p.hasFollowed(9));
  for (int k = 0; k < 80; ++k) p.next();
  EXPECT_LT((p.next().t - s.path.back().t).norm(), 0.01);
  EXPECT_TRUE(p.hasFollowed(15));
}

TEST(SimulatedOperator, TremblesByItsSkill) {
  OperatorSkill skill = exact();
  skill.tremor_m = 1e-3;
  SimulatedOperator p = person(skill);
  const Suggestion view = viewAt({0.2, 0.3, 1.1});
  p.show(view, 0);
  for (int k = 0; k < 150; ++k) p.next();
  double squares = 0;
  for (int k = 0; k < 400; ++k) squares += (p.next().t - view.T_FC0.t).squaredNorm() / 1200;
  EXPECT_NEAR(std::sqrt(squares), 1e-3, 1e-4);
}

TEST(SimulatedOperator, LosesPatienceWhenItIsOver) {
  OperatorSkill skill;
  skill.patience_s = 20;
  EXPECT_FALSE(person(skill).givesUp(19.9));
  EXPECT_TRUE(person(skill).givesUp(20));
  skill.speed_m_s = 0;
  EXPECT_THROW(skill.check(), InputError);
}

}  // namespace
}  // namespace plumbline
