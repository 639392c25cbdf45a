// SPDX-License-Identifier: BSD-3-Clause
// T_SC0 and time offsets of a file against those that a recording shows.
#include "evaluate/metrics/calibration/held_imu.h"

#include <Eigen/Geometry>
#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/records/shown_findings.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

CameraImuStageResult estimateOf(const Transform& T_SC0, double offset_s) {
  CameraImuStageResult stage;
  stage.summary.converged = true;
  stage.imu.T_SC0 = T_SC0;
  stage.imu.time_offsets = {{offset_s}};
  stage.imu.T_SC0_std = Vector6d(Vector6d::Constant(1e-4));
  stage.imu.time_offset_std_s = 1e-5;
  return stage;
}

Transform quarterTurn() {
  return {Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix(),
          Eigen::Vector3d(-0.02, -0.065, 0.01)};
}

TEST(HeldImu, AnExtrinsicOrOffsetThatTheRecordingContradictsIsBadAndTheMistakeNamed) {
  const auto judged = [](const Transform& T_SC0, double offset_s) {
    ImuCalibration held;
    held.T_SC0 = T_SC0;
    held.time_offsets = {{offset_s}};
    return judgeHeldImu(held, HeldOffset::kStated, estimateOf(quarterTurn(), 8e-3)).front();
  };
  EXPECT_EQ(judged(quarterTurn(), 8.02e-3).level, VerdictLevel::kGood);  // 1.4 deviations
  // Seven deviations are certain, and so no good result, however small.
  EXPECT_EQ(judged(quarterTurn(), 8.1e-3).level, VerdictLevel::kCaution);
  EXPECT_THAT(judged(quarterTurn(), 8.1e-3).advice, HasSubstr("below 5 mm, 0.2 deg and 0.5 ms"));
  EXPECT_EQ(judged(quarterTurn(), 9e-3).level, VerdictLevel::kCaution);
  const Finding inverted = judged(quarterTurn().inverse(), 8e-3);
  EXPECT_EQ(inverted.level, VerdictLevel::kBad);
  EXPECT_THAT(inverted.advice, HasSubstr("invert T_cam_imu"));
  // Turned by half a turn it is not the inverse, though the rotation is.
  Transform half = quarterTurn();
  half.R = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix() * half.R;
  EXPECT_EQ(judged(half, 8e-3).level, VerdictLevel::kBad);
  EXPECT_THAT(judged(half, 8e-3).advice, testing::Not(HasSubstr("invert")));
  EXPECT_THAT(judged(quarterTurn(), -8e-3).advice, HasSubstr("negate timeshift_cam_imu"));
  EXPECT_THAT(judged(quarterTurn(), 8).advice, HasSubstr("divide timeshift_cam_imu by 1000"));
  EXPECT_EQ(judged(quarterTurn(), 8).level, VerdictLevel::kBad);
}

TEST(HeldImu, CamerasAreNotBlamedWhereAnotherFaultExplainsAsMuch) {
  CameraImuStageResult seen = estimateOf(quarterTurn(), 8e-3);
  ImuCalibration held;
  held.T_SC0 = quarterTurn();
  held.T_SC0.t.x() += 3e-2;
  held.time_offsets = {{8e-3}};
  const auto advice = [&] { return judgeHeldImu(held, HeldOffset::kStated, seen).front().advice; };
  FaultDiagnosis& faults = seen.faults.emplace();
  faults.causes.emplace_back().fault = UnmodelledFault::kGivenCameras;
  EXPECT_THAT(advice(), HasSubstr("calibrate the cameras on it first"));
  faults.alternative.emplace().fault = UnmodelledFault::kTargetSize;
  EXPECT_THAT(advice(), HasSubstr("does not tell which of two"));
}

// Both sides are estimates: what the file itself states as its deviation is no contradiction.
TEST(HeldImu, TheDeviationsThatTheFileStatesCountToo) {
  ImuCalibration held;
  held.T_SC0 = quarterTurn();
  held.T_SC0.t.x() += 2e-3;
  held.time_offsets = {{8e-3}};
  const auto level = [&] {
    return judgeHeldImu(held, HeldOffset::kStated, estimateOf(quarterTurn(), 8e-3)).front().level;
  };
  EXPECT_EQ(level(), VerdictLevel::kCaution);
  held.T_SC0_std = Vector6d(Vector6d::Constant(7e-4));
  EXPECT_EQ(level(), VerdictLevel::kGood);
}

// A direction that the motion hardly determines must not hide what is wrong in another.
TEST(HeldImu, EveryComponentIsHeldAgainstItsOwnDeviation) {
  CameraImuStageResult seen = estimateOf(quarterTurn(), 8e-3);
  seen.imu.T_SC0_std->z() = 2e-2;
  ImuCalibration held;
  held.T_SC0 = quarterTurn();
  held.time_offsets = {{8e-3}};
  held.T_SC0.t.z() += 3e-2;
  const auto judged = [&] { return judgeHeldImu(held, HeldOffset::kStated, seen).front(); };
  EXPECT_EQ(judged().level, VerdictLevel::kGood);  // 1.06 deviations
  EXPECT_THAT(judged().evidence, HasSubstr("the most by 1.1 deviations (T_SC0.tz)"));
  held.T_SC0.t.x() += 2e-3;  // 14 deviations
  // The 30 mm along z are not certain: by size it is a little.
  EXPECT_EQ(judged().level, VerdictLevel::kCaution);
  EXPECT_THAT(judged().evidence, HasSubstr("(T_SC0.tx)"));
  EXPECT_THAT(judged().advice, HasSubstr("below 5 mm, 0.2 deg and 0.5 ms"));
  held.T_SC0.t.x() += 3e-2;
  EXPECT_EQ(judged().level, VerdictLevel::kBad);
}

// Robust deviations are those that `calibrate` states; of few degrees of freedom they are rough.
TEST(HeldImu, RobustDeviationsCountByTheirDegreesOfFreedom) {
  CameraImuStageResult seen = estimateOf(quarterTurn(), 8e-3);
  ImuCalibration held;
  held.T_SC0 = quarterTurn();
  held.T_SC0.t.x() += 2e-4;  // 1.4 of the formal deviations
  held.time_offsets = {{8e-3}};
  const auto level = [&] { return judgeHeldImu(held, HeldOffset::kStated, seen).front().level; };
  EXPECT_EQ(level(), VerdictLevel::kGood);
  FaultDiagnosis& faults = seen.faults.emplace();
  EXPECT_EQ(level(), VerdictLevel::kGood) << "they are not known";
  faults.robust_std.setConstant(4e-5);  // 3.5 deviations
  EXPECT_EQ(level(), VerdictLevel::kCaution);
  faults.robust_dof = Eigen::VectorXd::Constant(7, 4);  // with 8 degrees 2.7 of the normal ones
  EXPECT_EQ(level(), VerdictLevel::kGood);
  faults.robust_dof = Eigen::VectorXd::Constant(7, 100);
  EXPECT_EQ(level(), VerdictLevel::kCaution);
  faults.robust_dof->setZero();
  EXPECT_EQ(level(), VerdictLevel::kGood) << "by the formal ones";
  held.T_SC0_std = Vector6d(Vector6d::Constant(4e-5));
  seen.imu.T_SC0_std = held.T_SC0_std;
  EXPECT_EQ(level(), VerdictLevel::kCaution);
  held.T_SC0_dof = Vector6d(Vector6d::Constant(2));
  EXPECT_EQ(level(), VerdictLevel::kGood);
}

// On a synchronised rig any offset agrees with a thousandth of itself, and nearly with its
// opposite.
TEST(HeldImu, NoMistakeIsNamedThatNearZeroCannotBeTold) {
  ImuCalibration held;
  held.T_SC0 = quarterTurn();
  held.time_offsets = {{8e-3}};
  const Finding f =
      judgeHeldImu(held, HeldOffset::kStated, estimateOf(quarterTurn(), -1e-3)).front();
  EXPECT_EQ(f.level, VerdictLevel::kBad);
  EXPECT_THAT(f.advice, testing::Not(HasSubstr("divide")));
  held.time_offsets = {{2.9e-3}};
  EXPECT_THAT(
      judgeHeldImu(held, HeldOffset::kStated, estimateOf(quarterTurn(), -1e-3)).front().advice,
      testing::Not(HasSubstr("negate")));
}

TEST(HeldImu, AnOffsetThatTheFileDoesNotStateIsNoMoreThanACaution) {
  ImuCalibration held;
  held.T_SC0 = quarterTurn();
  const Finding f =
      judgeHeldImu(held, HeldOffset::kAssumed, estimateOf(quarterTurn(), 8e-3)).front();
  EXPECT_EQ(f.level, VerdictLevel::kCaution);
  EXPECT_THAT(f.evidence, HasSubstr("states no time offset"));
  EXPECT_THAT(f.advice, HasSubstr("timeshift_cam_imu"));
  EXPECT_THAT(f.advice, HasSubstr("8.000 ms"));
  EXPECT_THAT(f.advice, testing::Not(HasSubstr("contradicts")));
  // A transform that is off by a little does not make the assumed offset a mistake.
  held.T_SC0.t.x() += 2e-3;
  EXPECT_THAT(
      judgeHeldImu(held, HeldOffset::kAssumed, estimateOf(quarterTurn(), 8e-3)).front().advice,
      HasSubstr("8.000 ms"));
  held.T_SC0 = {};
  const Finding turned =
      judgeHeldImu(held, HeldOffset::kAssumed, estimateOf(quarterTurn(), 8e-3)).front();
  EXPECT_EQ(turned.level, VerdictLevel::kBad);
  EXPECT_THAT(turned.advice, HasSubstr("contradicts"));
}

TEST(HeldImu, TheOffsetOfEachCameraIsHeldAgainstTheRecording) {
  CameraImuStageResult seen = estimateOf(quarterTurn(), 8e-3);
  seen.cameras.resize(3);
  for (std::size_t c = 0; c < 3; ++c) seen.cameras[c].name = "cam" + std::to_string(c);
  // Synchronised cameras, of which the third seems 0.01 ms late.
  FaultDiagnosis& faults = seen.faults.emplace();
  for (const int camera : {1, 2}) {
    FaultTest test;
    test.fault = UnmodelledFault::kCameraDelay;
    test.camera = camera;
    test.estimate = Eigen::VectorXd::Constant(1, camera == 2 ? 1e-5 : 0);
    test.std = Eigen::VectorXd::Constant(1, 1e-5);
    faults.tests.push_back(test);
  }
  ImuCalibration held;
  held.T_SC0 = quarterTurn();
  const auto judged = [&](double of_second_s, HeldOffset offset = HeldOffset::kStated) {
    held.time_offsets = {{8e-3}, {8e-3 + of_second_s, true}, {8e-3}};
    const auto findings = judgeHeldImu(held, offset, seen);
    EXPECT_EQ(findings.size(), 2U);
    EXPECT_EQ(findings.front().level, VerdictLevel::kGood);
    return findings.back();
  };
  EXPECT_EQ(judged(0).level, VerdictLevel::kGood);
  EXPECT_EQ(judged(4e-5).level, VerdictLevel::kGood);  // 2.8 deviations of both
  // What is certain is no good result, however small.
  EXPECT_EQ(judged(0.4e-3).level, VerdictLevel::kCaution);
  EXPECT_THAT(judged(0.4e-3).advice, HasSubstr("of cam1 where less than 0.5 ms matter: on this"));
  // Files state no deviation of it. A camera that is held synchronised has none.
  held.time_offsets = {{8e-3}};
  faults.tests[0].estimate(0) = 4e-5;
  EXPECT_EQ(judgeHeldImu(held, HeldOffset::kStated, seen).back().level, VerdictLevel::kCaution);
  faults.robust_std.setConstant(1e-4);
  faults.robust_dof = Eigen::VectorXd::Constant(7, 4);  // 4 deviations, 2.4 of the normal ones
  EXPECT_EQ(judgeHeldImu(held, HeldOffset::kStated, seen).back().level, VerdictLevel::kGood);
  faults.robust_dof.reset();
  faults.tests[0].estimate(0) = 0;
  const Finding late = judged(4e-3);
  EXPECT_EQ(late.level, VerdictLevel::kCaution);
  EXPECT_NEAR(late.value, 4, 1e-9);
  EXPECT_THAT(late.advice, HasSubstr("timeshift_cam_imu of cam1"));
  EXPECT_THAT(late.advice, testing::Not(HasSubstr("cam2")));
  EXPECT_EQ(judged(6e-3).level, VerdictLevel::kBad);
  EXPECT_THAT(judged(6e-3).advice, HasSubstr("correct timeshift_cam_imu of cam1"));
  const Finding assumed = judged(6e-3, HeldOffset::kAssumed);
  EXPECT_EQ(assumed.level, VerdictLevel::kCaution);
  EXPECT_THAT(assumed.advice, HasSubstr("state timeshift_cam_imu of cam1"));
  // Another fault of the recording may look like a camera that is late.
  faults.causes.push_back(faults.tests[0]);
  EXPECT_EQ(judged(6e-3).level, VerdictLevel::kBad) << "the delay itself";
  faults.causes[0].fault = UnmodelledFault::kClockDrift;
  EXPECT_EQ(judged(6e-3).level, VerdictLevel::kCaution);
  faults.causes.clear();
  // What the recording says is the measure: a camera that is late there may be so in the file.
  faults.tests[0].estimate(0) = 4e-3;
  EXPECT_EQ(judged(4e-3).level, VerdictLevel::kGood);
  EXPECT_EQ(judged(0).level, VerdictLevel::kCaution);
  // Not synchronised: the batch estimates it.
  seen.imu.time_offsets = {{8e-3}, {11e-3, true}};
  faults.tests.clear();
  EXPECT_EQ(judged(3e-3).level, VerdictLevel::kGood);
  EXPECT_EQ(judged(0).level, VerdictLevel::kCaution);
}

TEST(HeldImu, ARecordingThatMovesTooLittleToTellIsNoFault) {
  const Finding f =
      judgeHeldImu({}, HeldOffset::kStated, Failure{FailureCode::kMotionInformationSingular, {}})
          .front();
  EXPECT_TRUE(isNotJudged(f)) << "neither";
  EXPECT_THAT(f.evidence, testing::StartsWith("not judged: on this recording"));
  EXPECT_THAT(shownEvidence(f), testing::StartsWith("on this recording"));
}

TEST(HeldImu, AnExtrinsicThatCouldNotBeTestedIsNotGood) {
  const Finding f = judgeHeldImu({}, HeldOffset::kStated,
                                 Failure{FailureCode::kAccelerometerAxes, {{"rms", 1.6}}})
                        .front();
  EXPECT_EQ(f.level, VerdictLevel::kCaution);
  EXPECT_THAT(f.evidence, HasSubstr("not tested"));
}

}  // namespace
}  // namespace plumbline
