// SPDX-License-Identifier: BSD-3-Clause
// Two clocks and two body frames on one analytic motion. Proves sign, accuracy and the claimed
// standard deviation; says nothing about estimators whose errors correlate over many seconds.
#include "calibrator/initialise/clock_offset.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/calibrator/simulate/sampled_trajectory.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

AnalyticTrajectory motion(MotionKind kind = MotionKind::kFull) {
  TrajectoryOptions options;
  options.kind = kind;
  return {AprilGrid{}, simulatedRig("euroc"), options};
}

SamplingOptions ours(std::uint64_t seed, double sigma_rad) {
  SamplingOptions o;
  o.from_s = 2;
  o.to_s = 50;
  o.rate_hz = 20;
  o.sigma_rad = sigma_rad;
  o.seed = seed;
  return o;
}

// Stamped `offset_s` later than ours, in another world, of another body, slightly unlike rates.
SamplingOptions theirs(std::uint64_t seed, double offset_s, double sigma_rad) {
  SamplingOptions o;
  o.to_s = 52;
  o.rate_hz = 187;
  o.clock_s = offset_s;
  o.T_WF = {expSO3({1, 2, -0.5}), {1, 2, 3}};
  o.T_SB = {expSO3({-0.7, 0.4, 2}), {0.1, 0, 0.05}};
  o.sigma_rad = sigma_rad;
  o.seed = seed;
  return o;
}

Result<ClockOffset> found(const Trajectory& estimate, const Trajectory& truth,
                          const ClockOffsetOptions& options = {}) {
  return estimateClockOffset(estimate.poses, truth.poses, options);
}

TEST(ClockOffset, OfExactTrajectoriesIsExactWithItsSign) {
  for (const double offset : {-0.9, -0.0123456, 0.0, 0.3, 0.9}) {
    const auto clock =
        found(sampled(motion(), ours(1, 0)), sampled(motion(), theirs(1, offset, 0)));
    ASSERT_TRUE(clock.ok());
    EXPECT_NEAR(clock->offset_s, offset, 2e-5) << offset;  // 1/2500 of a frame
    EXPECT_GT(clock->correlation, 0.999);
    EXPECT_EQ(clock->feature, RateFeature::kVectors);
    const Eigen::Matrix3d R_SM = theirs(1, 0, 0).T_SB.R;
    EXPECT_LT(rotationAngle(clock->R_MS * R_SM), 1e-3);
  }
}

TEST(ClockOffset, ErrorsAreWhatTheStandardDeviationSays) {
  constexpr int kSeeds = 40;
  double squares = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const double offset = seed % 2 == 0 ? 0.9 : -0.9 + 0.01 * seed;
    const auto clock =
        found(sampled(motion(), ours(seed, 2e-3)), sampled(motion(), theirs(seed, offset, 5e-4)));
    ASSERT_TRUE(clock.ok());
    const double normalised = (clock->offset_s - offset) / clock->std_s;
    EXPECT_LT(std::abs(normalised), 4.1) << seed;  // Student's t, 15 degrees of freedom: 0.1 %
    EXPECT_LT(clock->std_s, 1e-3) << seed;
    squares += normalised * normalised;
  }
  // Mean of 40 squares of Student's t (15 degrees of freedom): 1.15 +- 0.27, four of those above;
  // below, the sums over stretches keep some of the noise that telescopes.
  EXPECT_LT(squares / kSeeds, 2.3);
  EXPECT_GT(squares / kSeeds, 0.25);
}

// In gentle motion most of what the truth's rates change by is its noise: that is no information.
TEST(ClockOffset, TheDeviationHoldsInGentleMotion) {
  TrajectoryOptions gentle;
  gentle.pace = 0.2;
  const AnalyticTrajectory slow(AprilGrid{}, simulatedRig("euroc"), gentle);
  constexpr int kSeeds = 16;
  double squares = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const double offset = 0.02 * seed - 0.3;
    const auto clock =
        found(sampled(slow, ours(seed, 2e-3)), sampled(slow, theirs(seed, offset, 1e-3)));
    ASSERT_TRUE(clock.ok());
    squares += std::pow((clock->offset_s - offset) / clock->std_s, 2);
  }
  EXPECT_LT(std::sqrt(squares / kSeeds), 1.7);
}

TEST(ClockOffset, InvertedQuaternionsLeaveTheMagnitudes) {
  Trajectory truth = sampled(motion(), theirs(1, 0.25, 1e-4));
  for (StampedPose& pose : truth.poses) pose.q = pose.q.conjugate();
  const auto clock = found(sampled(motion(), ours(1, 1e-4)), truth);
  ASSERT_TRUE(clock.ok());
  EXPECT_EQ(clock->feature, RateFeature::kMagnitudes);
  EXPECT_NEAR(clock->offset_s, 0.25, 2e-3);
}

/// Turns about x whose rate has the magnitude 1 + slow(t), its sign drawn anew every second.
Trajectory turning(double swing, double rate_hz, std::uint64_t seed) {
  Trajectory trajectory;
  RandomStream random(seed, RandomPurpose::kTrajectory, {});
  double angle = 0, sign = 1;
  const int per_second = static_cast<int>(rate_hz);
  for (int i = 0; i < 60 * per_second; ++i) {
    if (i % per_second == 0) sign = random.uniform() < 0.5 ? -1 : 1;
    const double t = i / rate_hz, slow = 0.5 * std::sin(0.9 * t) + 0.3 * std::sin(1.31 * t + 1);
    const Eigen::Quaterniond q(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()));
    trajectory.poses.push_back(
        {1'400'000'000'000'000'000 + toNanoseconds(t), Eigen::Vector3d::Zero(), q});
    angle += sign * (1 + swing * slow) / rate_hz;
  }
  return trajectory;
}

// Two motions, one fast where the other is slow.
TEST(ClockOffset, MagnitudesThatFallAsTheOthersGrowAreNoMatch) {
  const auto clock = found(turning(1, 20, 1), turning(-1, 200, 2));
  ASSERT_FALSE(clock.ok());
  EXPECT_EQ(clock.failure().code, FailureCode::kClockRatesDoNotCorrelate);
  const auto same = found(turning(1, 20, 1), turning(1, 200, 2));
  ASSERT_TRUE(same.ok());
  EXPECT_EQ(same->feature, RateFeature::kMagnitudes);
}

TEST(ClockOffset, OfOneAxisIsFoundToo) {
  const AnalyticTrajectory turn = motion(MotionKind::kSingleAxisRotation);
  const auto clock = found(sampled(turn, ours(3, 1e-3)), sampled(turn, theirs(3, -0.4, 1e-3)));
  ASSERT_TRUE(clock.ok());
  EXPECT_NEAR(clock->offset_s, -0.4, 4 * clock->std_s);
  EXPECT_LT(clock->std_s, 3e-3);
}

TEST(ClockOffset, AWiderRangeFindsWhatANarrowOneRefuses) {
  const Trajectory estimate = sampled(motion(), ours(1, 1e-3));
  const Trajectory truth = sampled(motion(), theirs(1, 3.3, 1e-3));
  ClockOffsetOptions wide;
  wide.max_offset_s = 5;
  const auto clock = found(estimate, truth, wide);
  ASSERT_TRUE(clock.ok());
  EXPECT_NEAR(clock->offset_s, 3.3, 1e-3);
  const auto narrow = found(estimate, truth);
  ASSERT_FALSE(narrow.ok());
  EXPECT_EQ(narrow.failure().code, FailureCode::kClockRatesDoNotCorrelate);
}

// The steps from the grid's edge would lead to the offset, or stop on the way to it.
TEST(ClockOffset, AnOffsetBeyondTheRangeIsNoResult) {
  const Trajectory estimate = sampled(motion(), ours(1, 1e-3));
  const Trajectory truth = sampled(motion(), theirs(1, 0.32, 1e-3));
  ClockOffsetOptions options;
  for (const double range : {0.05, 0.1, 0.2, 0.25, 0.3}) {
    options.max_offset_s = range;
    const auto clock = found(estimate, truth, options);
    ASSERT_FALSE(clock.ok()) << range << ": " << clock->offset_s;
    if (range >= 0.2) {  // nearer to it the rates correlate enough
      EXPECT_EQ(clock.failure().code, FailureCode::kClockNotWithinRange) << range;
    }
  }
  for (const double range : {0.33, 0.5}) {
    options.max_offset_s = range;
    const auto clock = found(estimate, truth, options);
    ASSERT_TRUE(clock.ok()) << range;
    EXPECT_NEAR(clock->offset_s, 0.32, 1e-3) << range;
  }
}

TEST(ClockOffset, AStaticTrajectoryIsRefusedWithTheReason) {
  const AnalyticTrajectory still = motion(MotionKind::kStatic);
  const auto exact = found(sampled(still, ours(1, 0)), sampled(still, theirs(1, 0.1, 0)));
  ASSERT_FALSE(exact.ok());
  EXPECT_EQ(exact.failure().code, FailureCode::kClockNoRotation);
  const auto noisy = found(sampled(still, ours(1, 2e-3)), sampled(still, theirs(1, 0.1, 1e-3)));
  ASSERT_FALSE(noisy.ok());
  EXPECT_EQ(noisy.failure().reason(), FailureReason::kNotObservable);
}

TEST(ClockOffset, FewPosesAndFarSpansAreRefused) {
  Trajectory few = sampled(motion(), ours(1, 0));
  const Trajectory truth = sampled(motion(), theirs(1, 0, 0));
  Trajectory far = few;
  few.poses.resize(10);
  EXPECT_EQ(found(few, truth).failure().code, FailureCode::kClockTooFewRates);
  EXPECT_EQ(found(Trajectory{}, truth).failure().code, FailureCode::kClockTooFewRates);
  for (StampedPose& pose : far.poses) pose.t += 1'000'000'000'000;
  EXPECT_EQ(found(far, truth).failure().code, FailureCode::kClockNoOverlap);
}

}  // namespace
}  // namespace plumbline
