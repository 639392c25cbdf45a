// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/trajectory/alignment.h"

#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "evaluate/metrics/trajectory/errors.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

Eigen::Vector3d randomVector(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return {normal(random), normal(random), normal(random)};
}

const Transform kMotion(expSO3({0.3, -1.1, 0.7}), Eigen::Vector3d(4, -2, 9));

// Truth is a random walk; the estimate is what `T` and `scale` map onto it, with `noise` [m, rad].
std::vector<PosePair> pairsUnder(const Transform& T, double scale, double noise, int count = 200) {
  std::mt19937 random(7);
  std::vector<PosePair> pairs;
  Transform pose;
  for (int i = 0; i < count; ++i) {
    pose.t += 0.1 * randomVector(random);
    pose.R = expSO3(0.1 * randomVector(random)) * pose.R;
    const Eigen::Vector3d p = T.inverse() * (pose.t + noise * randomVector(random));
    const Eigen::Matrix3d R = T.R.transpose() * expSO3(noise * randomVector(random)) * pose.R;
    pairs.push_back({{i, p / scale, Eigen::Quaterniond(R)}, {i, pose.t, pose.quaternion()}});
  }
  // p_truth = T (scale p): a similarity with translation T.t.
  return pairs;
}

AlignmentOptions optionsOf(AlignmentKind kind, int first_n = 0) { return {kind, first_n}; }

double ate(const std::vector<PosePair>& pairs, AlignmentKind kind,
           AbsoluteMeasure measure = AbsoluteMeasure::kTranslation) {
  return sampleStatistics(
             absoluteErrors(alignedPoses(pairs, align(pairs, optionsOf(kind)).value()), measure))
      .rmse;
}

TEST(Align, Se3RecoversARigidMotion) {
  const auto found = align(pairsUnder(kMotion, 1, 0), optionsOf(AlignmentKind::kSe3));
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(found->kind, "se3");
  EXPECT_EQ(found->scale, 1);
  EXPECT_TRUE(found->T_truth_estimate.matrix().isApprox(kMotion.matrix(), 1e-12));
}

TEST(Align, Sim3RecoversTheScale) {
  const auto found = align(pairsUnder(kMotion, 2.5, 0), optionsOf(AlignmentKind::kSim3));
  EXPECT_NEAR(found->scale, 2.5, 1e-12);
  EXPECT_TRUE(found->T_truth_estimate.R.isApprox(kMotion.R, 1e-12));
  EXPECT_TRUE(found->T_truth_estimate.t.isApprox(kMotion.t, 1e-11));
}

TEST(Align, ScaleAloneKeepsTheFrame) {
  const auto found = align(pairsUnder(kMotion, 2.5, 0), optionsOf(AlignmentKind::kScale));
  EXPECT_NEAR(found->scale, 2.5, 1e-12);
  EXPECT_TRUE(found->T_truth_estimate.matrix().isIdentity(0));
}

TEST(Align, YawRecoversATurnAboutZAndNothingElse) {
  const Transform turn(expSO3({0, 0, 2.9}), Eigen::Vector3d(1, 2, 3));
  const auto fit = align(pairsUnder(turn, 1, 0), optionsOf(AlignmentKind::kYaw));
  EXPECT_TRUE(fit->T_truth_estimate.matrix().isApprox(turn.matrix(), 1e-12));
  const auto tilted = align(pairsUnder(kMotion, 1, 0), optionsOf(AlignmentKind::kYaw));
  EXPECT_NEAR(tilted->T_truth_estimate.R(2, 2), 1, 1e-15);
}

TEST(Align, SinglePosesCoincide) {
  const std::vector<PosePair> pairs = pairsUnder(kMotion, 1, 0.05);
  for (const AlignmentKind kind : {AlignmentKind::kOrigin, AlignmentKind::kSe3First}) {
    const AlignedPoses poses = alignedPoses(pairs, align(pairs, optionsOf(kind)).value());
    EXPECT_TRUE(poses.estimate[0].matrix().isApprox(poses.truth[0].matrix(), 1e-12));
  }
  const Transform turn(expSO3({0, 0, -2}), Eigen::Vector3d(1, 2, 3));
  const auto yaw = align(pairsUnder(turn, 1, 0), optionsOf(AlignmentKind::kYawFirst));
  EXPECT_TRUE(yaw->T_truth_estimate.matrix().isApprox(turn.matrix(), 1e-12));
}

TEST(Align, TheFitIsBestAmongItsNeighbours) {
  const std::vector<PosePair> pairs = pairsUnder(kMotion, 1.3, 0.05);
  std::mt19937 random(3);
  for (const AlignmentKind kind :
       {AlignmentKind::kSe3, AlignmentKind::kSim3, AlignmentKind::kYaw}) {
    const AlignmentRecord best = align(pairs, optionsOf(kind)).value();
    const auto cost = [&](const AlignmentRecord& a) {
      return sampleStatistics(absoluteErrors(alignedPoses(pairs, a), AbsoluteMeasure::kTranslation))
          .sse;
    };
    for (int trial = 0; trial < 30; ++trial) {
      AlignmentRecord moved = best;
      Eigen::Vector3d turn = 1e-3 * randomVector(random);
      if (kind == AlignmentKind::kYaw) turn.head<2>().setZero();
      moved.T_truth_estimate.R = expSO3(turn) * moved.T_truth_estimate.R;
      moved.T_truth_estimate.t += 1e-3 * randomVector(random);
      if (kind == AlignmentKind::kSim3) moved.scale *= 1 + 1e-3 * turn.x();
      EXPECT_GT(cost(moved), cost(best));
    }
  }
}

// Of points whose best orthogonal matrix is a mirror, here diag(1, 1, -1): the covariance is
// diag(18, 8, -2) / 6, and of proper rotations the identity is the best, with the scale
// (18 + 8 - 2) / (18 + 8 + 2) (Umeyama, 1991, eq. 42).
TEST(Align, AMirroredEstimateIsNotAlignedByAReflection) {
  std::vector<PosePair> pairs;
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(3, 0, 0), Eigen::Vector3d(0, 2, 0), Eigen::Vector3d(0, 0, 1)}) {
    for (const double sign : {1.0, -1.0}) {
      const Eigen::Vector3d x = sign * p, y(x.x(), x.y(), -x.z());
      pairs.push_back(
          {{0, x, Eigen::Quaterniond::Identity()}, {0, y, Eigen::Quaterniond::Identity()}});
    }
  }
  const auto found = align(pairs, optionsOf(AlignmentKind::kSim3));
  ASSERT_TRUE(found.ok());
  EXPECT_TRUE(found->T_truth_estimate.R.isIdentity(1e-12)) << found->T_truth_estimate.R;
  EXPECT_NEAR(found->scale, 24.0 / 28, 1e-12);
}

// Truth in map coordinates is millions of metres from their origin.
TEST(Align, FarFromTheOriginAMotionOfMetresIsOne) {
  const Transform far(kMotion.R, Eigen::Vector3d(4.6e6, 5.3e6, 400));
  const auto found = align(pairsUnder(far, 1, 0), optionsOf(AlignmentKind::kSe3));
  ASSERT_TRUE(found.ok());
  EXPECT_TRUE(found->T_truth_estimate.R.isApprox(far.R, 1e-6));
}

TEST(Align, AteDoesNotSeeARigidMotionOfTheEstimate) {
  const std::vector<PosePair> pairs = pairsUnder(Transform(), 1, 0.05);
  std::vector<PosePair> moved = pairs;
  for (PosePair& pair : moved) {
    pair.estimate.q = kMotion.quaternion() * pair.estimate.q;
    pair.estimate.p = kMotion * pair.estimate.p;
  }
  for (const AbsoluteMeasure m : {AbsoluteMeasure::kTranslation, AbsoluteMeasure::kRotationDeg}) {
    const double before = ate(pairs, AlignmentKind::kSe3, m);
    EXPECT_GT(before, 0.01);
    EXPECT_NEAR(ate(moved, AlignmentKind::kSe3, m), before, 1e-11 * before);
  }
}

TEST(Align, FirstNStandsOnTheFirstPairsAlone) {
  std::vector<PosePair> pairs = pairsUnder(kMotion, 1, 0);
  for (std::size_t i = 50; i < pairs.size(); ++i) pairs[i].estimate.p.x() += 5;
  const auto first = align(pairs, optionsOf(AlignmentKind::kSe3, 50));
  EXPECT_EQ(first->first_n, 50);
  EXPECT_TRUE(first->T_truth_estimate.matrix().isApprox(kMotion.matrix(), 1e-12));
  EXPECT_FALSE(align(pairs, optionsOf(AlignmentKind::kSe3))
                   ->T_truth_estimate.matrix()
                   .isApprox(kMotion.matrix(), 1e-3));
}

TEST(Align, RefusesWhatIsNotUniqueAndSaysWhy) {
  const auto refusal = [](const std::vector<PosePair>& pairs, const AlignmentOptions& options) {
    const auto found = align(pairs, options);
    EXPECT_FALSE(found.ok());
    return found.ok() ? FailureCode::kNoImu : found.failure().code;
  };
  EXPECT_EQ(refusal(pairsUnder(kMotion, 1, 0, 2), optionsOf(AlignmentKind::kSe3)),
            FailureCode::kTooFewPairs);
  EXPECT_EQ(refusal(pairsUnder(kMotion, 1, 0), optionsOf(AlignmentKind::kSim3, 2)),
            FailureCode::kTooFewPairs);
  EXPECT_EQ(refusal({}, optionsOf(AlignmentKind::kOrigin)), FailureCode::kNoPairs);

  std::vector<PosePair> line = pairsUnder(kMotion, 1, 0), still = line, vertical = line;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const Eigen::Vector3d along = Eigen::Vector3d(1, 2, 3) * static_cast<double>(i);
    line[i].truth.p = along + 1e-6 * line[i].truth.p;
    line[i].estimate.p = along;
    still[i].estimate.p = Eigen::Vector3d(1, 1, 1);
    vertical[i].estimate.p = vertical[i].truth.p = Eigen::Vector3d(5, 5, static_cast<double>(i));
  }
  EXPECT_EQ(refusal(line, optionsOf(AlignmentKind::kSe3)), FailureCode::kPositionsOnALine);
  EXPECT_TRUE(align(line, optionsOf(AlignmentKind::kYaw)).ok());
  EXPECT_EQ(refusal(still, optionsOf(AlignmentKind::kScale)), FailureCode::kPositionsStandStill);
  for (PosePair& pair : still) std::swap(pair.estimate.p, pair.truth.p);
  EXPECT_EQ(refusal(still, optionsOf(AlignmentKind::kScale)), FailureCode::kPositionsStandStill);
  EXPECT_EQ(refusal(vertical, optionsOf(AlignmentKind::kYaw)), FailureCode::kNoHorizontalMotion);
  // Half a turn about a horizontal axis has no yaw.
  const Transform half(expSO3({std::numbers::pi, 0, 0}), Eigen::Vector3d::Zero());
  EXPECT_EQ(refusal(pairsUnder(half, 1, 0), optionsOf(AlignmentKind::kYawFirst)),
            FailureCode::kUpsideDown);
}

TEST(Align, FirstNIsOfFitsAlone) {
  const std::vector<PosePair> pairs = pairsUnder(kMotion, 1, 0);
  EXPECT_EQ(align(pairs, optionsOf(AlignmentKind::kYaw, 50))->first_n, 50);
  EXPECT_EQ(align(pairs, optionsOf(AlignmentKind::kOrigin, 50))->first_n, 0);
}

}  // namespace
}  // namespace plumbline
