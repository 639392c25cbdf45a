// SPDX-License-Identifier: BSD-3-Clause
// Quantiles against tables; errors drawn from known covariances are inside the bounds as often as
// these say, overconfident covariances are outside. Errors here are independent from pose to pose,
// which those of an estimator are not.
#include <Eigen/Cholesky>
#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/simulate/random_stream.h"
#include "evaluate/metrics/trajectory/errors.h"

namespace plumbline {
namespace {

struct Sample {
  AlignedPoses poses;
  std::vector<Matrix6d> covariances;
};

// A covariance with correlated position and orientation; another for each pose.
Matrix6d covarianceOf(RandomStream& random) {
  Matrix6d A;
  for (int i = 0; i < 36; ++i) A(i / 6, i % 6) = random.normal();
  const Vector6d unit = (Vector6d() << 0.1, 0.1, 0.1, 0.02, 0.02, 0.02).finished();
  return unit.asDiagonal() * (A * A.transpose() / 6 + 0.2 * Matrix6d::Identity()) *
         unit.asDiagonal();
}

// Errors `factor` times as large as the covariances claim.
Sample sample(std::uint64_t seed, double factor) {
  RandomStream random(seed, RandomPurpose::kTrajectory);
  Sample s;
  for (int i = 0; i < 200; ++i) {
    s.covariances.push_back(covarianceOf(random));
    Vector6d z;
    for (int k = 0; k < 6; ++k) z[k] = factor * random.normal();
    const Transform T{expSO3({0.1 * i, 0.3, -0.02 * i}), {0.1 * i, 1, 2}};
    s.poses.truth.push_back(T);
    s.poses.estimate.push_back(
        boxplus(T, s.covariances.back().llt().matrixL().toDenseMatrix() * z));
  }
  return s;
}

bool inside(const NeesRecord& r) { return r.mean > r.lower && r.mean < r.upper; }

TEST(Nees, ConsistentErrorsAreInsideAsOftenAsStated) {
  constexpr int kSeeds = 200;
  std::array<int, 3> counts{};
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const Sample s = sample(seed, 1);
    const Nees nees = neesOf(s.poses, s.covariances);
    ASSERT_EQ(nees.parts.size(), 3U);
    for (std::size_t k = 0; k < 3; ++k) counts[k] += inside(nees.parts[k]) ? 1 : 0;
  }
  // 95 % of 200: 190 +- 3.1.
  for (const int count : counts) {
    EXPECT_GE(count, 178);
    EXPECT_LE(count, 199);
  }
}

TEST(Nees, BoundsAreChiSquareQuantilesOfTheSum) {
  const Sample s = sample(1, 1);
  const Nees nees = neesOf(s.poses, s.covariances);
  EXPECT_NEAR(200 * nees.parts[0].lower, 534.0185504659326, 1e-9);  // 3 x 200 degrees, 2.5 %
  EXPECT_NEAR(200 * nees.parts[0].upper, 669.7691522164111, 1e-9);
  EXPECT_NEAR(200 * nees.parts[2].lower, 1105.889881156058, 1e-9);
  EXPECT_NEAR(200 * nees.parts[2].upper, 1297.898276336810, 1e-9);
}

TEST(Nees, MeansAreTheDegreesOfFreedom) {
  const Sample s = sample(5, 1);
  const Nees nees = neesOf(s.poses, s.covariances);
  EXPECT_EQ(nees.parts[0].part, "position");
  EXPECT_EQ(nees.parts[1].part, "orientation");
  EXPECT_EQ(nees.parts[2].part, "pose");
  EXPECT_NEAR(nees.parts[0].mean, 3, 0.7);  // 4 sigma of sqrt(2 * 3 / 200)
  EXPECT_NEAR(nees.parts[2].mean, 6, 1.0);
  EXPECT_EQ(nees.used, 200U);
  EXPECT_EQ(nees.left_out, 0U);
}

TEST(Nees, OverconfidentCovariancesAreAboveAndCautiousOnesBelow) {
  for (int seed = 1; seed <= 20; ++seed) {
    const Sample bold = sample(seed, 1.5);
    for (const NeesRecord& r : neesOf(bold.poses, bold.covariances).parts) {
      EXPECT_GT(r.mean, r.upper) << r.part;
      EXPECT_EQ(r.reading, NeesReading::kOverconfident) << r.part;
    }
    const Sample cautious = sample(seed, 0.7);
    for (const NeesRecord& r : neesOf(cautious.poses, cautious.covariances).parts) {
      EXPECT_LT(r.mean, r.lower) << r.part;
      EXPECT_EQ(r.reading, NeesReading::kCautious) << r.part;
    }
  }
}

TEST(Nees, DoesNotDependOnTheTruthsFrame) {
  const Sample s = sample(3, 1);
  AlignmentRecord alignment;
  alignment.scale = 2;
  alignment.T_truth_estimate = {expSO3({1, -2, 0.5}), {3, 4, 5}};
  AlignedPoses turned;
  std::vector<Matrix6d> covariances;
  const auto moved = [&](const Transform& T) {
    const Transform& A = alignment.T_truth_estimate;
    return Transform(Eigen::Matrix3d(A.R * T.R), 2 * (A.R * T.t) + A.t);
  };
  for (std::size_t i = 0; i < s.covariances.size(); ++i) {
    turned.truth.push_back(moved(s.poses.truth[i]));
    turned.estimate.push_back(moved(s.poses.estimate[i]));
    covariances.push_back(alignedCovariance(s.covariances[i], alignment));
  }
  const Nees a = neesOf(s.poses, s.covariances), b = neesOf(turned, covariances);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(a.parts[k].mean, b.parts[k].mean, 1e-9);
}

TEST(Nees, SingularCovariancesAreCountedAndLeftOut) {
  Sample s = sample(1, 1);
  s.covariances[0].setZero();
  s.covariances[7](2, 2) = -1;
  const Nees nees = neesOf(s.poses, s.covariances);
  EXPECT_EQ(nees.left_out, 2U);
  EXPECT_EQ(nees.used, 198U);
  EXPECT_TRUE(neesOf({}, {}).parts.empty());
}

}  // namespace
}  // namespace plumbline
