// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "evaluate/metrics/trajectory/errors.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

Transform pose(const Eigen::Vector3d& turn_deg, const Eigen::Vector3d& t) {
  return {expSO3(turn_deg * kDegree), t};
}

std::vector<Transform> alongX(const std::vector<double>& x) {
  std::vector<Transform> poses;
  for (const double at : x) poses.push_back(pose({0, 0, 0}, {at, 0, 0}));
  return poses;
}

TEST(RotationVector, EqualsTheLogarithmUpToPi) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, -2, 0.5).normalized();
  for (const double angle :
       {0.0, 1e-9, 1e-5, 1e-3, 1.0, 3.0, 3.135, 3.14, std::numbers::pi - 1e-9}) {
    const Eigen::Vector3d w = rotationVector(expSO3(angle * axis));
    EXPECT_NEAR((w - angle * axis).norm(), 0, 1e-11) << angle;
  }
}

TEST(ShepperdQuaternion, InvertsRotationOfInEveryBranch) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Quaterniond q =
        Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
            .normalized();
    const Eigen::Quaterniond back = shepperdQuaternion(rotationOf(q, QuaternionUse::kNormalised));
    EXPECT_NEAR(std::abs(q.dot(back)), 1, 1e-14);
  }
}

TEST(RotationOf, AsReadKeepsTheLengthsError) {
  const Eigen::Quaterniond q(1.001, 0, 0, 0);
  EXPECT_TRUE(rotationOf(q, QuaternionUse::kNormalised).isIdentity(1e-15));
  EXPECT_NEAR(rotationOf(q, QuaternionUse::kAsRead)(0, 0), 2 * 1.001 * 1.001 - 1, 1e-15);
}

TEST(AbsoluteErrors, HandValues) {
  const AlignedPoses poses{{pose({0, 0, 0}, {1, 1, 1})}, {pose({0, 0, -60}, {4, 5, 13})}};
  const auto error = [&](AbsoluteMeasure m) { return absoluteErrors(poses, m).at(0); };
  EXPECT_DOUBLE_EQ(error(AbsoluteMeasure::kTranslation), 13);  // 3, 4, 12
  EXPECT_DOUBLE_EQ(error(AbsoluteMeasure::kXy), 5);
  EXPECT_NEAR(error(AbsoluteMeasure::kRotationDeg), 60, 1e-12);
  EXPECT_NEAR(error(AbsoluteMeasure::kYawDeg), -60, 1e-12);
  EXPECT_NEAR(error(AbsoluteMeasure::kHeadingDeg), 60, 1e-12);
  EXPECT_NEAR(error(AbsoluteMeasure::kRotationPart), std::sqrt(2), 1e-12);  // 2 sqrt2 sin 30
  EXPECT_NEAR(error(AbsoluteMeasure::kFullTransformation), std::sqrt(171), 1e-12);
}

TEST(AbsoluteErrors, ATiltIsNoYaw) {
  const AlignedPoses poses{{pose({10, 20, 30}, {0, 0, 0})}, {pose({25, 0, 0}, {0, 0, 0})}};
  AlignedPoses tilted = poses;
  tilted.estimate[0].R = expSO3({0.2, 0, 0}) * poses.truth[0].R;
  EXPECT_NEAR(absoluteErrors(tilted, AbsoluteMeasure::kYawDeg)[0], 0, 1e-12);
  EXPECT_NEAR(absoluteErrors(tilted, AbsoluteMeasure::kRotationDeg)[0], 0.2 / kDegree, 1e-12);
}

TEST(PosePairs, Frames) {
  EXPECT_THAT(overlappingFrames(4, 2), ElementsAre(IndexPair{0, 2}, IndexPair{1, 3}));
  EXPECT_THAT(consecutiveFrames(5, 2), ElementsAre(IndexPair{0, 2}, IndexPair{2, 4}));
  EXPECT_THAT(consecutiveFrames(4, 2), ElementsAre(IndexPair{0, 2}));
  EXPECT_THAT(overlappingFrames(2, 2), IsEmpty());
}

TEST(PosePairs, SubTrajectoriesTakeTheNearestWithinTheTolerance) {
  const std::vector<double> path{0, 0.4, 1.1, 1.1, 2.0, 5.0};
  EXPECT_THAT(subTrajectories(path, {1.0, 0.3}),
              ElementsAre(IndexPair{0, 2}, IndexPair{1, 2}, IndexPair{2, 4}, IndexPair{3, 4}));
  EXPECT_THAT(subTrajectories({0, 1.5}, {1.0, 0.5, true, false}), ElementsAre(IndexPair{0, 1}));
  EXPECT_THAT(subTrajectories({0, 1.5}, {1.0, 0.5, false, false}), IsEmpty());
  // Where the pose itself counts as an end, a short length pairs it with itself.
  EXPECT_THAT(subTrajectories({0, 1.5}, {0.1, 0.5, false, true}),
              ElementsAre(IndexPair{0, 0}, IndexPair{1, 1}));
}

TEST(PosePairs, ConsecutiveStretchesLoseTheFirst) {
  EXPECT_THAT(consecutiveSegments(alongX({0, 1, 2, 3, 4, 5, 6}), 2),
              ElementsAre(IndexPair{2, 4}, IndexPair{4, 6}));
  EXPECT_THAT(consecutiveSegments(alongX({0, 1, 2}), 2), IsEmpty());
}

// Three turns about z while the pitch passes 90 degrees: the angles make the rotations again, and
// neither the truth's nor those of an estimate 2 degrees beside it jump.
TEST(RollPitchYaw, OrientationsOverTimeHaveNoJumps) {
  std::vector<Transform> truth, estimate;
  for (int i = 0; i <= 300; ++i) {
    truth.push_back(pose({0, 0, 3.6 * i}, {0, 0, 0}) * pose({0, 0.1 + 0.5 * i, 0}, {0, 0, 0}));
    estimate.push_back(pose({0, 0, 2}, {0, 0, 0}) * truth.back());
  }
  const auto angles = rollPitchYaw(truth), beside = rollPitchYaw({truth, estimate}, angles);
  EXPECT_NEAR((angles.back() - Eigen::Vector3d(0, 150.1, 1080)).norm(), 0, 1e-9);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Eigen::Vector3d& a = angles[i];
    const Transform again = pose({0, 0, a[2]}, {0, 0, 0}) * pose({0, a[1], 0}, {0, 0, 0}) *
                            pose({a[0], 0, 0}, {0, 0, 0});
    EXPECT_LT((again.R - truth[i].R).norm(), 1e-9) << i;
    EXPECT_LT((beside[i] - a - Eigen::Vector3d(0, 0, 2)).norm(), 1e-6) << i;
    if (i > 0) {
      EXPECT_LT((a - angles[i - 1]).norm(), 10) << i;
    }
  }
}

// The body's x axis points up (a pitch of -90 degrees), where roll and yaw vary by much with little
// rotation: an estimate 3 degrees off never stays half a turn away.
TEST(RollPitchYaw, NearAPitchOf90DegreesTheEstimateKeepsToTheTruth) {
  AlignedPoses poses;
  for (int i = 0; i < 400; ++i) {
    const double t = 0.05 * i;
    poses.truth.push_back(
        pose({0, 0, 17 * t}, {0, 0, 0}) * pose({3 * std::sin(t), 2.3, 0}, {0, 0, 0}) *
        pose({0, -90, 0}, {0, 0, 0}) * pose({0, 3 * std::cos(0.7 * t), 0}, {0, 0, 0}));
    const double grown = std::min(1.0, t / 10);
    poses.estimate.push_back(poses.truth.back() *
                             pose(grown * Eigen::Vector3d(0.6, 2.9, 1.7), {0, 0, 0}));
  }
  const auto truth = rollPitchYaw(poses.truth), estimate = rollPitchYaw(poses, truth);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    // More than 90 degrees from one branch is less from the other.
    EXPECT_LE((estimate[i] - truth[i]).cwiseAbs().maxCoeff(), 135) << i;
  }
  EXPECT_LT((estimate.back() - truth.back()).cwiseAbs().maxCoeff(), 45);
}

// With another body frame, turned by 90 degrees, the angles are others, and yet follow the motion.
TEST(RollPitchYaw, AnotherBodyFrameMakesNoJumps) {
  std::vector<Transform> truth, estimate;
  for (int i = 0; i <= 300; ++i) {
    truth.push_back(pose({0, 0, 1.8 * i}, {0, 0, 0}) *
                    pose({20 * std::sin(0.1 * i), 0, 0}, {0, 0, 0}));
    estimate.push_back(truth.back() * pose({0, -70, 0}, {0, 0, 0}) * pose({0, 0, 90}, {0, 0, 0}));
  }
  const auto other = rollPitchYaw({truth, estimate}, rollPitchYaw(truth));
  for (std::size_t i = 1; i < other.size(); ++i) {
    EXPECT_LT((other[i] - other[i - 1]).cwiseAbs().maxCoeff(), 30) << i;
  }
}

TEST(RelativeErrors, HandValues) {
  // Over one step the truth goes 1 m; the estimate 1.5 m with a turn of 30 degrees about z.
  const AlignedPoses poses{{pose({0, 0, 0}, {0, 0, 0}), pose({0, 0, 0}, {1, 0, 0})},
                           {pose({0, 0, 90}, {7, 7, 7}), pose({0, 0, 120}, {7, 8.5, 7})}};
  const auto error = [&](RelativeMeasure m) { return relativeErrors(poses, {{0, 1}}, m).at(0); };
  EXPECT_NEAR(error(RelativeMeasure::kTranslation), 0.5, 1e-12);
  EXPECT_NEAR(error(RelativeMeasure::kRotationDeg), 30, 1e-12);
  EXPECT_NEAR(error(RelativeMeasure::kHeadingDeg), 30, 1e-12);
  EXPECT_NEAR(error(RelativeMeasure::kGravityDeg), 0, 1e-12);
}

// The truth stands still, lying on its side. Heading and tilt are those in the world, where gravity
// is, whatever the body's own axes.
TEST(RelativeErrors, HeadingAndTiltAreOfTheWorld) {
  const Transform side = pose({90, 0, 0}, {0, 0, 0});
  const auto error = [&](const Eigen::Vector3d& turn_deg, RelativeMeasure m) {
    const AlignedPoses poses{{side, side}, {side, pose(turn_deg, {0, 0, 0}) * side}};
    return relativeErrors(poses, {{0, 1}}, m).at(0);
  };
  EXPECT_NEAR(error({0, 0, -30}, RelativeMeasure::kHeadingDeg), 30, 1e-9);
  EXPECT_NEAR(error({0, 0, -30}, RelativeMeasure::kGravityDeg), 0, 1e-9);
  for (const Eigen::Vector3d& tilt : {Eigen::Vector3d(10, 0, 0), Eigen::Vector3d(0, -10, 0)}) {
    EXPECT_NEAR(error(tilt, RelativeMeasure::kHeadingDeg), 0, 1e-9);
    EXPECT_NEAR(error(tilt, RelativeMeasure::kGravityDeg), 10, 1e-9);
  }
}

TEST(RelativeErrors, DoNotSeeARigidMotion) {
  AlignedPoses poses{alongX({0, 1, 2, 3}), alongX({0, 1.1, 2.3, 3.1})};
  const std::vector<IndexPair> pairs = overlappingFrames(4, 1);
  const auto before = relativeErrors(poses, pairs, RelativeMeasure::kTranslation);
  for (Transform& T : poses.estimate) T = pose({20, 40, 60}, {5, 5, 5}) * T;
  const auto after = relativeErrors(poses, pairs, RelativeMeasure::kTranslation);
  for (std::size_t i = 0; i < pairs.size(); ++i) EXPECT_NEAR(after[i], before[i], 1e-13);
  EXPECT_NEAR(before[0], 0.1, 1e-13);
}

TEST(RelativeErrorOver, EachToolFindsItsPairs) {
  // The estimate is a fifth longer than the truth, so that it matters along which of them one goes.
  const AlignedPoses poses{alongX({0, 1, 2, 3, 4, 5, 6}), alongX({0, 1.2, 2.4, 3.6, 4.8, 6, 7.2})};
  using Unit = RelativeDelta::Unit;
  const auto pairs = [&](RelativePairs rule, double delta, Unit unit = Unit::kMetres) {
    return pairsOver({delta, unit, rule}, poses, {});
  };
  EXPECT_EQ(pairs(RelativePairs::kPlumbline, 2), overlappingFrames(7, 2));
  EXPECT_EQ(pairs(RelativePairs::kEvo, 2.4), consecutiveSegments(poses.estimate, 2.4));
  EXPECT_EQ(pairs(RelativePairs::kEvoAll, 2.4), overlappingFrames(7, 2));
  EXPECT_EQ(pairs(RelativePairs::kPlumbline, 2.2), overlappingFrames(7, 2));  // 9 % short of it
  EXPECT_THAT(pairs(RelativePairs::kPlumbline, 2.25), IsEmpty());             // 11 %
  EXPECT_EQ(pairs(RelativePairs::kRpg, 2.4), overlappingFrames(7, 2));
  EXPECT_THAT(pairs(RelativePairs::kRpg, 2.5), IsEmpty());  // 20 % are excluded
  EXPECT_EQ(pairs(RelativePairs::kOvEval, 2.4), overlappingFrames(7, 2));
  EXPECT_EQ(pairs(RelativePairs::kEvo, 2, Unit::kFrames), consecutiveFrames(7, 2));
  EXPECT_EQ(pairs(RelativePairs::kEvoAll, 2, Unit::kFrames), overlappingFrames(7, 2));
  EXPECT_FALSE(hasPairsOver(RelativePairs::kRpg, Unit::kFrames));
  EXPECT_FALSE(hasPairsOver(RelativePairs::kEvo, Unit::kSeconds));
}

TEST(RelativeErrorOver, EachUnitFindsItsPairs) {
  const AlignedPoses poses{alongX({0, 1, 2, 3, 4}), alongX({0, 1.1, 2.2, 3.3, 4.4})};
  std::vector<TimeNs> t;
  for (int i = 0; i < 5; ++i) t.push_back(500'000'000LL * i);
  using Unit = RelativeDelta::Unit;
  const auto over = [&](double delta, Unit unit) {
    return relativeErrorOver({delta, unit}, poses, t);
  };
  EXPECT_EQ(over(2, Unit::kMetres).translation_m.n, 3U);
  EXPECT_NEAR(over(2, Unit::kMetres).translation_m.rmse, 0.2, 1e-12);
  EXPECT_EQ(over(1, Unit::kSeconds).translation_m.n, 3U);
  EXPECT_EQ(over(1, Unit::kFrames).rotation_deg.n, 4U);
  EXPECT_EQ(over(9, Unit::kMetres).translation_m.n, 0U);
  EXPECT_EQ(over(1, Unit::kSeconds).unit, "s");
}

}  // namespace
}  // namespace plumbline
