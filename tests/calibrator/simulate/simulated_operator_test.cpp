// SPDX-License-Identifier: BSD-3-Clause
// A simulated person does what is asked for, as late, as slowly and as inexactly as skill says.
#include "calibrator/simulate/operator/simulated_operator.h"

#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"

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
  s.duration_s = 5;
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

// Told to go before it was noticed, as when the trajectory before ended where this one starts.
TEST(SimulatedOperator, DoesNotFollowATrajectoryThatIsIgnored) {
  Suggestion s = viewAt({0.2, 0.3, 1.2});
  s.path = {s.T_FC0, viewAt({0.7, 0.3, 1.2}).T_FC0};
  s.duration_s = 5;
  for (const double compliance : {0.0, 1.0}) {
    OperatorSkill skill = exact();
    skill.compliance = compliance;
    SimulatedOperator p = person(skill);
    p.show(s, 0);
    p.go(0);
    EXPECT_TRUE(p.isFollowing());
    for (int k = 0; k < 80; ++k) p.next();
    EXPECT_EQ(p.isFollowing(), compliance == 1);
    EXPECT_EQ(p.hasFollowed(8), compliance == 1);
  }
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

// On the straight way to a view the hand passes it by the share of the way, and comes back.
TEST(SimulatedOperator, PassesAViewByItsShareOfTheWay) {
  for (const double share : {0.0, 0.1, 0.2}) {
    OperatorSkill skill = exact();
    skill.reaction_s = 0;
    skill.overshoot = share;
    SimulatedOperator p = person(skill);
    const Eigen::Vector3d begin = p.next().t;
    const Suggestion view = viewAt({0.8, 0.3, 1.4});
    p.show(view, 0);
    const Eigen::Vector3d way = view.T_FC0.t - begin;
    double farthest = 0;
    for (int k = 0; k < 200; ++k) {
      farthest = std::max(farthest, (p.next().t - begin).dot(way) / way.squaredNorm());
    }
    // A hand drifts on by some per cent as it slows down, whatever it means to do.
    EXPECT_NEAR(farthest, 1 + share, 0.06) << share;
    EXPECT_LT((p.next().t - view.T_FC0.t).norm(), 5e-3) << "and comes back";
  }
}

/// The way of the hand in the ten seconds after `from_s` [m].
double wayInTenSeconds(const OperatorSkill& skill, double from_s) {
  SimulatedOperator p = person(skill);
  for (int k = 0; k < from_s / kSpacing; ++k) p.next();
  double way = 0;
  Transform last = p.next();
  for (int k = 0; k < 100; ++k) {
    const Transform now = p.next();
    way += (now.t - last.t).norm();
    last = now;
  }
  return way;
}

TEST(SimulatedOperator, TiresWithTime) {
  OperatorSkill skill = exact();
  skill.speed_m_s = 0.15;  // speed is what limits it
  const double fresh = wayInTenSeconds(skill, 295);
  skill.fatigue_per_min = 0.2;  // after five minutes half as fast
  EXPECT_NEAR(wayInTenSeconds(skill, 295) / fresh, 0.5, 0.1);
  skill = exact();
  skill.tremor_m = 1e-3;
  skill.fatigue_per_min = 0.2;
  SimulatedOperator p = person(skill);
  const Suggestion view = viewAt({0.2, 0.3, 1.1});
  p.show(view, 0);
  for (int k = 0; k < 2800; ++k) p.next();
  double squares = 0;
  for (int k = 0; k < 400; ++k) squares += (p.next().t - view.T_FC0.t).squaredNorm() / 1200;
  EXPECT_NEAR(std::sqrt(squares), 2e-3, 2e-4) << "and trembles twice as much";
}

TEST(SimulatedOperator, FollowsTheShareOfSuggestionsOfItsCompliance) {
  OperatorSkill skill = exact();
  skill.reaction_s = 0;
  skill.compliance = 0.7;
  int followed = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SimulatedOperator p = person(skill, seed);
    const Suggestion view = viewAt({0.21, 0.33, 1.13});
    p.show(view, 0);
    for (int k = 0; k < 120; ++k) p.next();
    followed += (p.next().t - view.T_FC0.t).norm() < 1e-3 ? 1 : 0;
  }
  EXPECT_NEAR(followed / 300.0, 0.7, 0.08);  // three standard deviations
}

TEST(SimulatedOperator, KeepsTheBoardInView) {
  OperatorSkill skill = exact();
  skill.off_axis_rad = 0.3;
  const AprilGrid target;
  const Eigen::Vector3d centre(0.5 * target.width(), 0.5 * target.height(), 0);
  SimulatedOperator p = person(skill);
  Suggestion away = viewAt({0.3, 0.3, 1.2});
  away.T_FC0.R = away.T_FC0.R * expSO3({0, 0.8, 0});  // the board would be 46 degrees aside
  p.show(away, 0);
  for (int k = 0; k < 150; ++k) p.next();
  const Eigen::Vector3d seen = p.next().inverse() * centre;
  EXPECT_NEAR(std::atan2(seen.head<2>().norm(), seen.z()), 0.3, 0.02);
}

// About each axis of the camera in turn, then along each, three times to and fro.
TEST(OwnViews, DanceAboutAndAlongEachAxis) {
  OperatorSkill skill = exact();
  skill.own_views = OwnViewsKind::kDance;
  OwnViews views(skill, AprilGrid(), 1.0);
  RandomStream random(1, RandomPurpose::kTrajectory, {1});
  for (int axis = 0; axis < 6; ++axis) {
    for (int time = 0; time < 3; ++time) {
      const Transform to = views.next(random), fro = views.next(random);
      const Eigen::Vector3d turn = logSO3(fro.R.transpose() * to.R), way = to.t - fro.t;
      const Eigen::Vector3d moved = axis < 3 ? turn : way, still = axis < 3 ? way : turn;
      EXPECT_LT(still.norm(), 1e-9);
      EXPECT_GT(moved[axis % 3], 0.2);
      EXPECT_NEAR(moved.norm(), moved[axis % 3], 1e-9);
    }
  }
  const Transform one = views.next(random), other = views.next(random);
  EXPECT_GT((one.t - other.t).norm(), 0.05) << "then all around";
  EXPECT_GT(rotationAngle(one.R.transpose() * other.R), 0.05);
}

TEST(PersonSkill, GoesFromTheMostSkilledToTheLeast) {
  const OperatorSkill expert = personSkill(0), novice = personSkill(1);
  EXPECT_LT(expert.reaction_s, novice.reaction_s);
  EXPECT_LT(expert.overshoot, novice.overshoot);
  EXPECT_LT(expert.fatigue_per_min, novice.fatigue_per_min);
  EXPECT_EQ(expert.compliance, 1);
  EXPECT_LT(novice.compliance, 0.9);
  EXPECT_GT(expert.speed_m_s, personSkill(0.5).speed_m_s);
  novice.check();
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
