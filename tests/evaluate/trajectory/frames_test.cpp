// SPDX-License-Identifier: BSD-3-Clause
// Clock, marker body, quaternion order and covariances through the whole evaluation.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluate/metrics/failure_text.h"
#include "evaluate/trajectory/evaluate_trajectory.h"
#include "report/records/documents.h"
#include "tests/calibrator/simulate/sampled_trajectory.h"

namespace plumbline {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

const Transform kT_SM{expSO3({0.4, -0.3, 0.7}), {0.12, -0.08, 0.05}};

AnalyticTrajectory motion(MotionKind kind = MotionKind::kFull) {
  TrajectoryOptions options;
  options.kind = kind;
  return {AprilGrid{}, simulatedRig("euroc"), options};
}

// An IMU's estimate at 20 Hz; noise 2 mm, 1 mrad.
Trajectory estimate(const AnalyticTrajectory& m, std::uint64_t seed = 1) {
  SamplingOptions o;
  o.from_s = 2;
  o.to_s = 40;
  o.sigma_m = 2e-3;
  o.sigma_rad = 1e-3;
  o.seed = seed;
  return sampled(m, o);
}

// Markers at 200 Hz, stamped later by `clock_s`.
Trajectory markers(const AnalyticTrajectory& m, double clock_s) {
  SamplingOptions o;
  o.to_s = 42;
  o.rate_hz = 200;
  o.clock_s = clock_s;
  o.T_WF = {expSO3({0, 0, 1}), {3, 2, 1}};
  o.T_SB = kT_SM;
  o.sigma_m = 2e-4;
  o.sigma_rad = 2e-4;
  return sampled(m, o);
}

TEST(TrajectoryFrames, ClockAndHandEyeLeaveTheNoise) {
  TrajectoryMetricOptions options;
  const Trajectory ours = estimate(motion()), theirs = markers(motion(), 0.31);
  options.association.rule = AssociationRule::kInterpolate;
  const auto without = evaluateTrajectories(ours, theirs, options);
  ASSERT_TRUE(without.ok());
  EXPECT_GT(without->ate_translation_m.rmse, 0.05);
  options.clock = ClockOffsetOptions{};
  options.hand_eye = true;
  const auto with = evaluateTrajectories(ours, theirs, options);
  ASSERT_TRUE(with.ok()) << with.failure();
  ASSERT_TRUE(with->clock_offset && with->hand_eye);
  EXPECT_NEAR(with->clock_offset->offset_s, 0.31, 4 * with->clock_offset->std_s);
  EXPECT_NEAR(with->association.time_offset_s, with->clock_offset->offset_s, 1e-12);
  const Vector6d error = boxminus(with->hand_eye->T_SM, kT_SM);
  EXPECT_LT(error.cwiseQuotient(with->hand_eye->T_SM_std).cwiseAbs().maxCoeff(), 5);
  EXPECT_LT(error.head<3>().norm(), 2e-3);
  EXPECT_NEAR(with->ate_translation_m.rmse, 2e-3 * std::sqrt(3), 4e-4);
  EXPECT_LT(with->ate_rotation_deg.rmse, 0.15);
  EXPECT_THAT(with->remarks, Contains(HasSubstr("hand-eye")));
  EXPECT_THAT(documentOf(SingleTrajectory{*with, {}, {}}), HasSubstr("\"hand_eye\""));
}

// In gentle motion the offset is uncertain by milliseconds, which move the lever arm by more than
// the noise of the poses does.
TEST(TrajectoryFrames, TheMarkersDeviationHoldsTheClocks) {
  TrajectoryOptions gentle;
  gentle.pace = 0.2;
  const AnalyticTrajectory slow(AprilGrid{}, simulatedRig("euroc"), gentle);
  TrajectoryMetricOptions options;
  options.clock = ClockOffsetOptions{};
  options.hand_eye = true;
  SamplingOptions noisy;
  noisy.to_s = 42;
  noisy.rate_hz = 100;
  noisy.clock_s = 0.31;
  noisy.T_SB = kT_SM;
  noisy.sigma_m = 2e-4;
  noisy.sigma_rad = 1e-3;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    noisy.seed = 100 + seed;
    const auto found = evaluateTrajectories(estimate(slow, seed), sampled(slow, noisy), options);
    ASSERT_TRUE(found.ok()) << found.failure();
    const Vector6d error = boxminus(found->hand_eye->T_SM, kT_SM);
    EXPECT_LT(error.cwiseQuotient(found->hand_eye->T_SM_std).cwiseAbs().maxCoeff(), 5) << seed;
  }
}

TEST(TrajectoryFrames, ASearchIsAboutTheOffsetThatIsGiven) {
  TrajectoryMetricOptions options;
  options.clock = ClockOffsetOptions{};
  options.association.time_offset_s = 30;
  const auto found = evaluateTrajectories(estimate(motion()), markers(motion(), 30.2), options);
  ASSERT_TRUE(found.ok()) << found.failure();
  EXPECT_NEAR(found->clock_offset->offset_s, 30.2, 1e-3);
}

TEST(TrajectoryFrames, WhatCannotBeEstimatedIsRefused) {
  TrajectoryMetricOptions options;
  options.hand_eye = true;
  const AnalyticTrajectory turn = motion(MotionKind::kSingleAxisRotation);
  const auto axis = evaluateTrajectories(estimate(turn), markers(turn, 0), options);
  ASSERT_FALSE(axis.ok());
  EXPECT_EQ(axis.failure().code, FailureCode::kHandEyeOneAxis);
  options.alignment.kind = AlignmentKind::kSim3;
  const auto scale = evaluateTrajectories(estimate(motion()), markers(motion(), 0), options);
  ASSERT_FALSE(scale.ok());
  EXPECT_EQ(scale.failure().code, FailureCode::kScaleUnknown);
}

TEST(TrajectoryFrames, WFirstIsRefusedWithTheCure) {
  Trajectory wrong = estimate(motion());
  for (StampedPose& pose : wrong.poses) {
    const Eigen::Quaterniond q = pose.q;
    pose.q.coeffs() << q.w(), q.x(), q.y(), q.z();
  }
  const auto found = evaluateTrajectories(wrong, markers(motion(), 0), {});
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.failure().code, FailureCode::kQuaternionsWFirst);
  EXPECT_THAT(textOf(found.failure()).message, HasSubstr("of the estimate are w-first"));
  EXPECT_THAT(textOf(found.failure()).cure, HasSubstr("--estimate-w-first"));
}

// Pose noise that the covariances state, times `factor`.
TrajectoryRun judged(double factor, AlignmentKind kind) {
  Trajectory ours = estimate(motion(), 3);
  Matrix6d P = Matrix6d::Zero();
  P.diagonal() << Eigen::Vector3d::Constant(4e-6), Eigen::Vector3d::Constant(1e-6);
  ours.covariances.assign(ours.poses.size(), factor * factor * P);
  SamplingOptions exact;
  exact.from_s = 2;
  exact.to_s = 40;
  TrajectoryMetricOptions options;
  options.alignment.kind = kind;
  return evaluateTrajectories(ours, sampled(motion(), exact), options).value();
}

TEST(TrajectoryFrames, NeesTellsConsistentFromOverconfident) {
  const auto consistent = judged(1, AlignmentKind::kNone);
  ASSERT_EQ(consistent.nees.size(), 3U);
  for (const NeesRecord& r : consistent.nees) {
    EXPECT_GT(r.mean, r.lower) << r.part;
    EXPECT_LT(r.mean, r.upper) << r.part;
  }
  EXPECT_THAT(consistent.remarks, IsEmpty());
  for (const NeesRecord& r : judged(0.8, AlignmentKind::kNone).nees) {
    EXPECT_GT(r.mean, r.upper) << r.part;
  }
  EXPECT_THAT(judged(1, AlignmentKind::kSe3).remarks, Contains(HasSubstr("NEES after alignment")));
}

}  // namespace
}  // namespace plumbline
