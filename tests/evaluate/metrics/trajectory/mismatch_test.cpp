// SPDX-License-Identifier: BSD-3-Clause
// Lengths and stamps that differ by one figure are told from errors of the estimate.
#include "evaluate/metrics/trajectory/mismatch.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace plumbline {
namespace {

/// A hand-held way of 40 s whose like is never walked again, at `rate_hz` from `start_s`; 2 m wide.
Trajectory wayOf(double rate_hz, double start_s = 0) {
  Trajectory way;
  for (int i = 0; i < static_cast<int>(40 * rate_hz); ++i) {
    const double t = start_s + i / rate_hz;
    const Eigen::AngleAxisd yaw(std::sin(0.8 * t) + 0.4 * std::sin(1.9 * t),
                                Eigen::Vector3d::UnitZ());
    const Eigen::AngleAxisd pitch(0.5 * std::sin(1.1 * t), Eigen::Vector3d::UnitY());
    way.poses.push_back({toNanoseconds(t),
                         {std::sin(0.9 * t) + 0.3 * std::sin(2.3 * t),
                          std::cos(0.61 * t) + 0.02 * t, 0.4 * std::sin(1.27 * t + 1)},
                         Eigen::Quaterniond(yaw * pitch)});
  }
  return way;
}

/// A car at 10 m/s on a winding road for 40 s, of a body `ahead_m` in front of its axle.
Trajectory driveOf(double rate_hz, double ahead_m) {
  Trajectory drive;
  constexpr double kStep = 1e-3;  // of the integral over the heading [s]
  const auto headingAt = [](double t) { return std::sin(0.35 * t) + 0.3 * std::sin(0.9 * t + 1); };
  Eigen::Vector3d axle = Eigen::Vector3d::Zero();
  const int every = static_cast<int>(1 / (kStep * rate_hz));
  for (int i = 0; i < 40'000; ++i) {
    const double t = kStep * i, heading = headingAt(t);
    const Eigen::Vector3d forward(std::cos(heading), std::sin(heading), 0);
    if (i % every == 0) {
      drive.poses.push_back(
          {toNanoseconds(t), axle + ahead_m * forward,
           Eigen::Quaterniond(Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()))});
    }
    axle += 10 * kStep * forward;
  }
  return drive;
}

/// In another world, with lengths times `scale`, stamps later by `later_s`, noise of `sigma_m` on
/// positions and a drift by as much as `drift_m` in the end.
struct Change {
  double scale = 1, later_s = 0, sigma_m = 0, drift_m = 0;
};

Trajectory changed(Trajectory way, const Change& change) {
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0, change.sigma_m > 0 ? change.sigma_m : 1);
  const auto n = static_cast<double>(way.poses.size());
  double done = 0;
  for (StampedPose& pose : way.poses) {
    Eigen::Vector3d p = change.scale * (R * pose.p) + Eigen::Vector3d(4, 5, -6);
    if (change.sigma_m > 0) p += Eigen::Vector3d(noise(random), noise(random), noise(random));
    pose.p = p + change.drift_m * done / n * Eigen::Vector3d(1, 1, 0);
    pose.q = Eigen::Quaterniond(R) * pose.q;
    pose.t += toNanoseconds(change.later_s);
    ++done;
  }
  return way;
}

std::vector<PosePair> paired(const Trajectory& estimate, const Trajectory& truth) {
  return associate(estimate, truth, {}).pairs;
}

std::optional<ScaleMismatch> scaleOf(const Trajectory& estimate, const Trajectory& truth) {
  return scaleMismatch(paired(estimate, truth));
}

std::optional<ClockMismatch> clockOf(const Trajectory& estimate, const Trajectory& truth,
                                     double given_s = 0) {
  ClockTrialOptions options;
  options.time_offset_s = given_s;
  return clockMismatch(estimate, truth, options);
}

Trajectory everyNth(const Trajectory& whole, std::size_t n) {
  Trajectory some;
  for (std::size_t i = 0; i < whole.poses.size(); i += n) some.poses.push_back(whole.poses[i]);
  return some;
}

TEST(Mismatch, MillimetresAreFoundOnEitherSide) {
  const Trajectory truth = wayOf(100);
  for (const double scale : {1000.0, 1e-3, 0.3048, 1.4}) {
    const auto m = scaleOf(changed(wayOf(20), {.scale = scale, .sigma_m = 0.01 * scale}), truth);
    ASSERT_TRUE(m) << scale;
    EXPECT_NEAR(m->scale * scale, 1, 1e-3);
    EXPECT_NEAR(m->scaled_ate_m, 0.01 * std::sqrt(3), 1e-3) << "the noise is what is left";
    EXPECT_GT(m->ate_m, 0.2);
  }
}

TEST(Mismatch, AnEstimateOfTheTruthsScaleHasNone) {
  EXPECT_FALSE(scaleOf(changed(wayOf(20), {.sigma_m = 0.01}), wayOf(100)));
  EXPECT_FALSE(scaleOf(changed(wayOf(20), {.scale = 1.1}), wayOf(100))) << "an error like others";
}

// The best scale of what has nothing to do with the truth makes a point of it: no unit does that.
TEST(Mismatch, AnEstimateThatDivergedIsNoMatterOfScale) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> step(0, 1);
  Trajectory walk = wayOf(20);
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  for (StampedPose& pose : walk.poses) {
    at += Eigen::Vector3d(step(random), step(random), step(random));
    pose.p = at;
  }
  EXPECT_FALSE(scaleOf(walk, wayOf(100)));
  EXPECT_FALSE(clockOf(walk, wayOf(100)));
}

TEST(Mismatch, AnOffsetOfTheClocksIsFoundFromPositionsAndConfirmedByRates) {
  const Trajectory truth = wayOf(100);
  for (const double later_s : {-1.2, -0.5, 0.05, 0.5, 1.2}) {
    const auto m = clockOf(changed(wayOf(20), {.later_s = later_s, .sigma_m = 0.01}), truth);
    ASSERT_TRUE(m) << later_s;
    // 800 poses of 0.01 m at 0.8 m/s: std 0.5 ms.
    EXPECT_NEAR(m->positions_s, -later_s, 2e-3);
    EXPECT_NEAR(m->rates_s.value_or(0), -later_s, 1e-3);
    EXPECT_EQ(ratesConfirm(*m), true);
    EXPECT_NEAR(m->moved_ate_m, 0.01 * std::sqrt(3), 2e-3) << "the noise is what is left";
    EXPECT_GE(m->ate_m, 2 * m->moved_ate_m);
  }
}

// Both on one grid: on the way to the offset no stamps lie near each other.
TEST(Mismatch, AnOffsetIsFoundAgainstASparseTruth) {
  for (const double rate_hz : {10.0, 20.0}) {
    for (const double later_s : {0.3, 0.4, 0.7, 1.0}) {
      const auto m = clockOf(changed(wayOf(rate_hz), {.later_s = later_s}), wayOf(rate_hz));
      ASSERT_TRUE(m) << later_s << " at " << rate_hz;
      EXPECT_NEAR(m->positions_s, -later_s, 0.01);
    }
  }
}

// An alignment takes most of what a late clock does to a car on a winding road.
TEST(Mismatch, AnOffsetBehindTheAlignmentIsFound) {
  for (const double rate_hz : {20.0, 100.0}) {
    const auto m = clockOf(changed(driveOf(20, 0), {.later_s = 0.5}), driveOf(rate_hz, 0));
    ASSERT_TRUE(m) << rate_hz;
    EXPECT_NEAR(m->positions_s, -0.5, 0.01);
    EXPECT_EQ(ratesConfirm(*m), true);
  }
}

TEST(Mismatch, AnOffsetOfFewKeyframesIsFound) {
  const Trajectory keyframes = everyNth(changed(wayOf(20), {.later_s = 0.5}), 20);  // 1 a second
  const auto m = clockOf(keyframes, wayOf(100));
  ASSERT_TRUE(m);
  EXPECT_NEAR(m->positions_s, -0.5, 2e-3);
  EXPECT_FALSE(m->rates_s) << "the rotation between them is no rate";
  EXPECT_FALSE(ratesConfirm(*m).has_value());
}

// On a road every body travels along the way: one that lies ahead is where the other will be.
TEST(Mismatch, ABodyThatTravelsAheadIsNoOffsetByTheRates) {
  const auto m = clockOf(driveOf(20, 1.5), driveOf(100, 0));
  ASSERT_TRUE(m);
  EXPECT_NEAR(m->positions_s, 0.15, 0.01);
  ASSERT_TRUE(m->rates_s);
  EXPECT_NEAR(*m->rates_s, 0, 1e-3);
  EXPECT_EQ(ratesConfirm(*m), false);
}

TEST(Mismatch, PositionsAloneTellNoCauseApart) {
  Trajectory estimate = driveOf(20, 1.5);
  estimate.has_orientation = false;
  const auto m = clockOf(estimate, driveOf(100, 0));
  ASSERT_TRUE(m);
  EXPECT_FALSE(ratesConfirm(*m).has_value());
}

TEST(Mismatch, AnOffsetThatWasGivenIsNotAskedForAgain) {
  const auto m = clockOf(changed(wayOf(20), {.later_s = 0.5}), wayOf(100), -0.3);
  ASSERT_TRUE(m);
  EXPECT_EQ(m->given_s, -0.3);
  EXPECT_NEAR(m->positions_s, -0.2, 1e-3);
  EXPECT_NEAR(m->rates_s.value_or(0), -0.2, 1e-3);
}

TEST(Mismatch, NoiseAndDriftAreNoOffset) {
  const Trajectory truth = wayOf(100);
  EXPECT_FALSE(clockOf(changed(wayOf(20), {.sigma_m = 0.05}), truth));
  EXPECT_FALSE(clockOf(changed(wayOf(20), {.drift_m = 1}), truth));
  EXPECT_FALSE(clockOf(changed(wayOf(20), {.scale = 1.1}), truth));
}

// Stamps of the two lie 10 ms apart, on grids of 50 ms: the clocks are right.
TEST(Mismatch, StampsBetweenTheTruthsAreNoOffset) {
  EXPECT_FALSE(clockOf(changed(wayOf(20, 0.01), {}), wayOf(20)));
  EXPECT_FALSE(clockOf(changed(wayOf(20, 0.01), {.sigma_m = 0.002}), wayOf(20)));
}

TEST(Mismatch, AnOffsetBeyondTheRangeIsNotClaimed) {
  EXPECT_FALSE(clockOf(changed(wayOf(20), {.later_s = 6}), wayOf(100)));
}

}  // namespace
}  // namespace plumbline
