// SPDX-License-Identifier: BSD-3-Clause
// Marker body to IMU from simulated motion: exact recovery, the covariance's claim over 100 seeds,
// and the directions that cannot be seen. Drift, which breaks the claim, is not simulated.
#include "calibrator/batch/hand_eye.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/simulate/random_stream.h"
#include "calibrator/simulate/trajectory.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

const Transform kT_SM{expSO3({1.9, -0.4, 0.8}), {0.11, -0.07, 0.05}};
const Transform kT_VW{expSO3({0, 0.1, -2.2}), {4, -2, 1}};

struct Example {
  MotionKind kind = MotionKind::kFull;
  double offset_s = 0;  // t_truth - t_estimate of what happened together
  double sigma_m = 0, sigma_rad = 0;
  std::uint64_t seed = 1;
};

Vector6d noise(RandomStream& random, const Example& e) {
  Vector6d d;
  for (int k = 0; k < 6; ++k) d[k] = (k < 3 ? e.sigma_m : e.sigma_rad) * random.normal();
  return d;
}

// 300 pairs over 30 s whose stamps agree; the estimate's clock is late by -offset.
std::vector<HandEyePair> pairsOf(const Example& e) {
  TrajectoryOptions options;
  options.kind = e.kind;
  const AnalyticTrajectory motion(AprilGrid{}, simulatedRig("euroc"), options);
  RandomStream random(e.seed, RandomPurpose::kTrajectory, {77});
  std::vector<HandEyePair> pairs;
  for (int i = 0; i < 300; ++i) {
    const MotionState body = attached(motion.at(0.1 * i), kT_SM);
    HandEyePair pair;
    pair.T_VM = kT_VW * body.T_FB;
    pair.v_V = kT_VW.R * body.v_F;
    pair.omega_V = pair.T_VM.R * body.omega_B;
    pair.T_WS = motion.at(0.1 * i + e.offset_s).T_FB;
    pair.T_WS = boxplus(pair.T_WS, noise(random, e));
    pair.T_VM = boxplus(pair.T_VM, noise(random, e));
    pairs.push_back(pair);
  }
  return pairs;
}

TEST(HandEye, OfExactPairsIsExact) {
  const auto found = estimateHandEye(pairsOf({}));
  ASSERT_TRUE(found.ok());
  EXPECT_LT(boxminus(found->state.T_SM, kT_SM).norm(), 1e-9);
  EXPECT_LT(boxminus(found->state.T_VW, kT_VW).norm(), 1e-9);
  EXPECT_LT(found->rms_translation_m, 1e-9);
  EXPECT_EQ(found->covariance.rows(), 12);
}

// The rounding of many pairs with large coordinates is longer than the step that is asked for.
TEST(HandEye, OfManyExactPairsFarAwayIsExact) {
  const Eigen::Vector3d far(400, -300, 20);
  std::vector<HandEyePair> pairs;
  for (int k = 0; k < 10; ++k) {
    for (HandEyePair pair : pairsOf({})) {
      pair.T_VM.t += far;
      pairs.push_back(pair);
    }
  }
  const auto found = estimateHandEye(pairs);
  ASSERT_TRUE(found.ok()) << found.failure();
  EXPECT_LT((found->state.T_VW.t - kT_VW.t - far).norm(), 1e-8);
  EXPECT_LT(boxminus(found->state.T_SM, kT_SM).norm(), 1e-8);
}

TEST(HandEye, OfANumberThatIsNoneThereIsNoResult) {
  std::vector<HandEyePair> pairs = pairsOf({});
  pairs[7].T_VM.t.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(estimateHandEye(pairs).ok());
}

TEST(HandEye, FindsTheClockOffsetWithIt) {
  HandEyeOptions options;
  options.with_offset = true;
  for (const double offset : {-0.004, 0.004}) {
    const auto found = estimateHandEye(pairsOf({.offset_s = offset}), options);
    ASSERT_TRUE(found.ok());
    // The truth is carried on by its velocity; over 4 ms its acceleration is worth 40 um.
    EXPECT_NEAR(found->state.offset_s, offset, 1e-5);
    EXPECT_LT(boxminus(found->state.T_SM, kT_SM).norm(), 1e-3);
    EXPECT_EQ(found->covariance.rows(), 13);
  }
}

// Normal quantile 3.9: one in ten thousand on each side (Wilson and Hilferty).
double handEyeQuantile(double dof, double z) {
  const double a = 2 / (9 * dof);
  return dof * std::pow(1 - a + z * std::sqrt(a), 3);
}

void expectHandEyeChiSquare(double sum, double dof) {
  EXPECT_GT(sum, handEyeQuantile(dof, -3.7));
  EXPECT_LT(sum, handEyeQuantile(dof, 3.7));
}

TEST(HandEye, NormalisedErrorsOfAHundredSeedsAreChiSquare) {
  constexpr int kSeeds = 100;
  double all = 0, marker = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const auto found =
        estimateHandEye(pairsOf({.sigma_m = 3e-3, .sigma_rad = 4e-3, .seed = std::uint64_t(seed)}));
    ASSERT_TRUE(found.ok());
    Eigen::Matrix<double, 12, 1> error;
    error << boxminus(found->state.T_SM, kT_SM), boxminus(found->state.T_VW, kT_VW);
    const Eigen::MatrixXd& P = found->covariance;
    all += error.dot(P.ldlt().solve(error));
    const Matrix6d P_SM = P.topLeftCorner<6, 6>();
    marker += error.head<6>().dot(P_SM.ldlt().solve(error.head<6>()));
  }
  expectHandEyeChiSquare(all, 12 * kSeeds);
  expectHandEyeChiSquare(marker, 6 * kSeeds);
}

TEST(HandEye, NoiseIsEstimatedFromTheResiduals) {
  constexpr int kSeeds = 30;
  double sigma_m = 0, sigma_rad = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const auto found =
        estimateHandEye(pairsOf({.sigma_m = 3e-3, .sigma_rad = 4e-3, .seed = std::uint64_t(seed)}));
    sigma_m += found->sigma_m / kSeeds;
    sigma_rad += found->sigma_rad / kSeeds;
  }
  // Both sides are noisy; a position also carries the rotation's noise over the lever. The mean of
  // 30 times 900 residuals is good to 0.43 per cent.
  const double lever = 4e-3 * kT_SM.t.norm() * std::sqrt(2.0 / 3);
  EXPECT_NEAR(sigma_m / std::hypot(3e-3 * std::sqrt(2), lever), 1, 0.017);
  EXPECT_NEAR(sigma_rad / (4e-3 * std::sqrt(2)), 1, 0.017);
}

TEST(HandEye, StatedNoiseIsScaledByWhatIsLeft) {
  const auto pairs = pairsOf({.sigma_m = 3e-3, .sigma_rad = 4e-3});
  const auto free = estimateHandEye(pairs);
  HandEyeOptions stated;
  stated.sigma_m = 2 * free->sigma_m;
  stated.sigma_rad = 2 * free->sigma_rad;
  const auto scaled = estimateHandEye(pairs, stated);
  EXPECT_LT((scaled->covariance - free->covariance).norm(), 0.02 * free->covariance.norm());
}

TEST(HandEye, ATurnAboutOneAxisNamesTheAxis) {
  const auto found = estimateHandEye(
      pairsOf({.kind = MotionKind::kSingleAxisRotation, .sigma_m = 1e-3, .sigma_rad = 1e-3}));
  ASSERT_FALSE(found.ok());
  ASSERT_EQ(found.failure().code, FailureCode::kHandEyeOneAxis);
  const auto axis = std::get<Eigen::Vector3d>(found.failure().values.at("axis").content());
  EXPECT_LT((axis - Eigen::Vector3d::UnitY()).norm(), 0.01) << axis.transpose();
}

TEST(HandEye, WithoutTurnsNothingIsClaimed) {
  const auto found = estimateHandEye(pairsOf({.kind = MotionKind::kStatic}));
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.failure().code, FailureCode::kHandEyeNoRotation);
  EXPECT_EQ(estimateHandEye({}).failure().code, FailureCode::kHandEyeTooFewPairs);
}

TEST(HandEye, PositionsThatDoNotFollowAreImplausible) {
  auto pairs = pairsOf({});
  for (HandEyePair& pair : pairs) pair.T_VM.t = Eigen::Vector3d(-1, 1, 1).cwiseProduct(pair.T_VM.t);
  const auto found = estimateHandEye(pairs);
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.failure().code, FailureCode::kHandEyePositionsDisagree);
}

TEST(HandEye, InvertedQuaternionsAreImplausible) {
  auto pairs = pairsOf({});
  for (HandEyePair& pair : pairs) pair.T_VM.R.transposeInPlace();
  const auto found = estimateHandEye(pairs);
  ASSERT_FALSE(found.ok());
  EXPECT_THAT(found.failure().code, ::testing::AnyOf(FailureCode::kHandEyeRotationsDisagree,
                                                     FailureCode::kHandEyePositionsDisagree));
}

}  // namespace
}  // namespace plumbline
