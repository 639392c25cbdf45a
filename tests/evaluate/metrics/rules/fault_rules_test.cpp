// SPDX-License-Identifier: BSD-3-Clause
// What the verdict says of faults that the batch has no parameter for, and where they were not
// tested.
#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluate/metrics/failure_text.h"
#include "evaluate/metrics/rules/rules.h"
#include "evaluate/metrics/verdict.h"
#include "tests/evaluate/metrics/verdict_records.h"

namespace plumbline {
namespace {

using test::cameraRecord;
using test::findingOf;
using test::levelOf;

/// The diagnosis, to be filled, of a stage of one frame.
FaultDiagnosis& diagnosisIn(CalibrationRecord& record, double formal_std) {
  CameraImuStageResult& stage = record.camera_imu.emplace();
  stage.frames.push_back({0, {0}});
  FaultDiagnosis& faults = stage.faults.emplace();
  faults.formal_std.setConstant(formal_std);
  return faults;
}

TEST(FaultRules, SaysWhereFaultsAndGivenCamerasWereNotTested) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  record.camera_imu = CameraImuStageResult();
  record.camera_imu->frames.push_back({0, {0}});
  const char* const rule = "Faults that the calibration does not model";
  const Finding calibrated = findingOf(judge(record), rule);
  EXPECT_EQ(calibrated.evidence.find("not tested: the tests need at least 8 s"), 0U);
  EXPECT_EQ(calibrated.level, VerdictLevel::kCaution) << "nothing speaks for the deviations";
  EXPECT_NE(calibrated.advice.find("record 10 s or more"), std::string::npos);
  EXPECT_EQ(calibrated.evidence.find("given cameras"), std::string::npos) << calibrated.evidence;
  record.camera.reset();
  const Finding given = findingOf(judge(record), rule);
  EXPECT_NE(given.evidence.find("given cameras"), std::string::npos) << given.evidence;
  // Long enough, so that it was the solution that could not be tested.
  for (int s = 1; s <= 8; ++s) record.camera_imu->frames.push_back({toNanoseconds(s), {0}});
  const Finding refused = findingOf(judge(record), rule);
  EXPECT_EQ(refused.level, VerdictLevel::kCaution);
  EXPECT_FALSE(refused.advice.empty());
  EXPECT_EQ(refused.evidence.find("not tested: the solver stopped"), 0U) << refused.evidence;
}

TEST(FaultRules, AWrongSizeBelowTheBoundOfACauseIsACaution) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  record.camera_imu.emplace().frames.push_back({0, {0}});
  FaultTest test;
  test.fault = UnmodelledFault::kTargetSize;
  const auto level = [&](double off, double std, double sigma) {
    test.estimate = Eigen::VectorXd::Constant(1, off);
    test.std = Eigen::VectorXd::Constant(1, std);
    test.significance = sigma;
    FaultDiagnosis& faults = record.camera_imu->faults.emplace();
    faults.tests = {test};
    faults.formal_std.setConstant(1e-3);
    faults.robust_std.setConstant(2e-3);
    return levelOf(judge(record), "Size of the target by the batch");
  };
  EXPECT_EQ(level(-0.0305, 0.0052, 4.3), VerdictLevel::kCaution);  // stated 3 % too large
  EXPECT_EQ(level(0.2, 0.02, 4.9), VerdictLevel::kCaution);        // never bad
  EXPECT_EQ(level(0.015, 0.0066, 2.0), VerdictLevel::kGood);       // gentle motion, size as stated
  EXPECT_EQ(level(-0.009, 0.0005, 4.9), VerdictLevel::kGood);      // too little to matter
  // Far outside the linear range, as of a camera that turns in place: no test.
  EXPECT_EQ(level(-0.54, 0.07, 6.6), VerdictLevel::kGood);
  EXPECT_THAT(findingOf(judge(record), "Size of the target by the batch").evidence,
              ::testing::StartsWith("not judged"));
  EXPECT_EQ(level(0.2, std::nan(""), 4.9), VerdictLevel::kCaution);
  EXPECT_EQ(level(0.2, 0.02, std::nan("")), VerdictLevel::kCaution);
  // Below the bound as well, where it moves T_SC0 by three of its larger deviations.
  test.shift(2) = 5e-3;
  EXPECT_EQ(level(-0.0177, 0.0039, 4.2), VerdictLevel::kGood);
  test.shift(2) = 7e-3;
  EXPECT_EQ(level(-0.0177, 0.0039, 4.2), VerdictLevel::kCaution);
  EXPECT_EQ(level(-0.0177, 0.0039, 2.9), VerdictLevel::kGood);
  EXPECT_EQ(findingOf(judge(record), "Size of the target by the batch").unit, "share");
  level(-0.0177, 0.0039, 4.2);
  const Finding moves = findingOf(judge(record), "Size of the target by the batch");
  EXPECT_EQ(moves.unit, "sigma");
  EXPECT_DOUBLE_EQ(moves.value, 3.5);
  EXPECT_EQ(moves.threshold, 3);
  // Of few seconds the deviations are known less well.
  EXPECT_EQ(level(-0.0177, 0.0039, 3.2), VerdictLevel::kGood);
  for (int s = 1; s <= 60; ++s) record.camera_imu->frames.push_back({toNanoseconds(s), {0}});
  EXPECT_EQ(level(-0.0177, 0.0039, 3.2), VerdictLevel::kCaution);
  // Where a cause is named, that says it.
  record.camera_imu->faults->causes = {test};
  for (const Finding& finding : judge(record).findings) {
    EXPECT_NE(finding.rule, "Size of the target by the batch");
  }
}

TEST(FaultRules, OfTwoFaultsThatAreNotToldApartTheWorseCounts) {
  CalibrationRecord record;
  CameraImuStageResult& stage = record.camera_imu.emplace();
  stage.frames.push_back({0, {0}});
  FaultDiagnosis& faults = stage.faults.emplace();
  faults.formal_std.setConstant(1e-4);
  const auto level = [&] { return levelOf(judge(record), "Unmodelled fault"); };
  FaultTest test;
  test.fault = UnmodelledFault::kAccelMisalignment;
  test.estimate = test.std = Eigen::VectorXd::Constant(6, 1e-3);
  faults.tests = faults.causes = {test};
  EXPECT_EQ(level(), VerdictLevel::kGood);
  test.fault = UnmodelledFault::kGyroMisalignment;
  faults.alternative = test;
  EXPECT_EQ(level(), VerdictLevel::kGood);
  faults.alternative->shift(3) = 5e-5;
  EXPECT_EQ(findingOf(judge(record), "Unmodelled fault").value, 0) << "the first cause's";
  faults.alternative->shift(3) = 17e-4;
  EXPECT_EQ(level(), VerdictLevel::kCaution);
  EXPECT_NEAR(findingOf(judge(record), "Unmodelled fault").value, 17, 1e-9);
  EXPECT_THAT(findingOf(judge(record), "Unmodelled fault").evidence,
              ::testing::HasSubstr("of the alternative: modelling it"));
  EXPECT_THAT(findingOf(judge(record), "Unmodelled fault").advice,
              ::testing::AllOf(::testing::HasSubstr("If the former: calibrate the accelerometer's"),
                               ::testing::HasSubstr("If the latter: calibrate the gyroscope's")));
  EXPECT_THAT(textOf(notConverged(stage)).cure,
              ::testing::HasSubstr("If the latter: calibrate the gyroscope's"));
  faults.alternative->shift(3) = 17e-3;
  EXPECT_EQ(level(), VerdictLevel::kCaution) << "it may be the other";
  // Two sensors with time offsets of their own: the calibration states one.
  test.fault = UnmodelledFault::kImuDelay;
  test.estimate = test.std = Eigen::VectorXd::Constant(1, 5e-4);
  faults.alternative.reset();
  faults.causes = {test};
  EXPECT_EQ(level(), VerdictLevel::kCaution);
}

// Further causes were tested with the first in the model.
TEST(FaultRules, ABatchThatDoesNotConvergeNamesAllThatWasFoundInItsOrder) {
  CameraImuStageResult stage;
  stage.frames.push_back({0, {0}});
  FaultTest test;
  test.fault = UnmodelledFault::kGyroBiasJump;
  test.estimate = test.std = Eigen::Vector3d::Constant(1e-3);
  FaultDiagnosis& faults = stage.faults.emplace();
  faults.causes = {test};
  EXPECT_THAT(textOf(notConverged(stage)).message,
              ::testing::HasSubstr("; where it stopped, one fault explains the residuals best: "
                                   "jump of the gyroscope's bias: "));
  test.fault = UnmodelledFault::kAccelBiasJump;
  faults.causes.push_back(test);
  EXPECT_THAT(textOf(notConverged(stage)).cure, ::testing::StartsWith("look for a sensor that"))
      << "one cure for both";
  test.fault = UnmodelledFault::kTargetMoved;
  faults.causes.push_back(test);
  const FailureText told = textOf(notConverged(stage));
  EXPECT_THAT(
      told.message,
      ::testing::AllOf(
          ::testing::HasSubstr(
              "; where it stopped, 3 faults explain the residuals, found one after the other, each "
              "beside those before it: (1) jump of the gyroscope's"),
          ::testing::HasSubstr("; (2) jump of the accelerometer's bias: "),
          ::testing::HasSubstr("; (3) displacement of the target")));
  EXPECT_THAT(told.cure, ::testing::HasSubstr("; (3) fix the target and record again"));
}

TEST(FaultRules, GivenCamerasThatDoNotSuitAreNamedAndTheGyroscopeIsNotBlamed) {
  CalibrationRecord record;
  CameraImuStageResult& stage = record.camera_imu.emplace();
  stage.frames.push_back({0, {0}});
  stage.cameras.resize(1);
  stage.cameras[0].name = "cam0";
  stage.cameras[0].intrinsics.projection = Eigen::Vector4d(460, 460, 376, 240);
  stage.cameras[0].intrinsics.distortion = Eigen::Vector4d::Zero();
  stage.imu_summary.noise.gyro.factor = 3.6;
  stage.imu_summary.noise.gyro.redundancy = 1000;
  const auto density = [&] { return findingOf(judge(record), "Noise density of the gyroscope"); };
  EXPECT_THAT(density().advice, ::testing::HasSubstr("(not tested)"));
  FaultTest test;
  test.fault = UnmodelledFault::kGivenCameras;
  test.estimate = test.std = Eigen::VectorXd::Constant(8, 0.1);
  test.estimate(1) = -4.6;
  test.shift(2) = 9e-3;
  FaultDiagnosis& faults = stage.faults.emplace();
  faults.formal_std.setConstant(3e-4);
  EXPECT_THAT(density().advice, ::testing::HasSubstr("raise it by that factor"));
  faults.tests = faults.causes = {test};
  EXPECT_THAT(density().advice, ::testing::HasSubstr("Mend the given cameras first"));
  faults.alternative = test;
  faults.alternative->fault = UnmodelledFault::kTargetSize;
  EXPECT_THAT(density().advice, ::testing::HasSubstr("whether it is the given cameras"));
  faults.alternative.reset();
  const Finding fault = findingOf(judge(record), "Unmodelled fault");
  EXPECT_EQ(fault.level, VerdictLevel::kCaution);
  EXPECT_THAT(fault.evidence, ::testing::HasSubstr("cam0.fv -4.6 px (+- 0.1)"));
  EXPECT_THAT(fault.advice, ::testing::HasSubstr("--free-cameras"));
  // By the bounds on deviations; of other recordings' cameras many formal deviations are no more.
  stage.faults->causes[0].shift(2) = 27e-3;
  EXPECT_EQ(findingOf(judge(record), "Unmodelled fault").level, VerdictLevel::kBad);
  EXPECT_EQ(findingOf(judge(record), "Unmodelled fault").unit, "m");
}

TEST(FaultRules, AFaultIsSaidOfTheCameraByItsName) {
  CalibrationRecord record = cameraRecord(0.3, 0.5);
  CameraImuStageResult& stage = record.camera_imu.emplace();
  stage.frames.push_back({0, {0}});
  stage.cameras.resize(2);
  stage.cameras[1].name = "cam2";  // the second of --only cam0,cam2
  FaultTest test;
  test.fault = UnmodelledFault::kCameraDelay;
  test.camera = 1;
  test.estimate = Eigen::VectorXd::Constant(1, 2e-3);
  test.std = Eigen::VectorXd::Constant(1, 1e-5);
  FaultDiagnosis& faults = stage.faults.emplace();
  faults.formal_std.setConstant(3e-4);
  faults.tests = faults.causes = {test};
  EXPECT_THAT(findingOf(judge(record), "Unmodelled fault").evidence,
              ::testing::HasSubstr("under equal stamps of cam2: +2 ms"));
}

TEST(FaultRules, AReadoutTimeIsToldOfItsCameraOrAsOneEstimateForAll) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  CameraImuStageResult& stage = record.camera_imu.emplace();
  stage.frames.push_back({0, {0}});
  FaultTest test;
  test.fault = UnmodelledFault::kLineDelay;
  test.estimate = Eigen::VectorXd::Constant(1, 10e-3);
  test.std = Eigen::VectorXd::Constant(1, 1e-5);
  FaultDiagnosis& faults = stage.faults.emplace();
  faults.formal_std.setConstant(3e-4);
  const auto evidence = [&](int cameras, int camera) {
    stage.cameras.resize(cameras);
    stage.cameras.back().name = "last";
    test.camera = camera;
    faults.tests = faults.causes = {test};
    return findingOf(judge(record), "Unmodelled fault").evidence;
  };
  EXPECT_THAT(evidence(1, -1), ::testing::HasSubstr("(rolling shutter): +10 ms"));
  EXPECT_THAT(evidence(2, -1), ::testing::HasSubstr("shutter), one estimate for all cameras: +10"));
  EXPECT_THAT(evidence(2, 1), ::testing::HasSubstr("(rolling shutter) of last: +10 ms"));
}

TEST(FaultRules, AFaultSaysWhichOfItsComponentsWereNotTested) {
  CalibrationRecord record;
  FaultTest test;
  test.fault = UnmodelledFault::kGyroScale;
  test.chi2 = 100;
  test.estimate = Eigen::Vector3d(0.02, 0, 0);
  test.std = Eigen::Vector3d(1e-3, 1e-3, std::nan(""));
  FaultDiagnosis& faults = diagnosisIn(record, 1e-4);
  FaultTest beyond = test;
  beyond.fault = UnmodelledFault::kAccelScale;
  beyond.chi2 = 0;
  faults.tests = {test, beyond};
  EXPECT_THAT(findingOf(judge(record), "Faults that the calibration does not model").evidence,
              ::testing::AllOf(::testing::HasSubstr("none of 1 tested"),
                               ::testing::HasSubstr("linear range: accel-scale; in part, "),
                               ::testing::EndsWith("every component: gyro-scale")));
  faults.causes = {test};
  EXPECT_THAT(
      findingOf(judge(record), "Unmodelled fault").evidence,
      ::testing::AllOf(::testing::HasSubstr("x +2 % (+- 0.1), not determined by this motion: z; "),
                       ::testing::EndsWith("best among 1 faults tested")));
  faults.causes.front().std.setConstant(std::nan(""));
  EXPECT_THAT(findingOf(judge(record), "Unmodelled fault").evidence,
              ::testing::HasSubstr("no component is known by itself, not determined by this "
                                   "motion: x, y, z"));
}

TEST(FaultRules, ThreeScalesThatAreOneMayBeGravity) {
  CalibrationRecord record;
  FaultTest test;
  test.fault = UnmodelledFault::kAccelScale;
  test.chi2 = 100;
  test.std = Eigen::Vector3d::Constant(1e-4);
  FaultDiagnosis& faults = diagnosisIn(record, 1e-9);
  test.shift.setConstant(1e-3);
  const auto advice = [&](double x, double y, double z) {
    test.estimate = Eigen::Vector3d(x, y, z);
    faults.tests = faults.causes = {test};
    return findingOf(judge(record), "Unmodelled fault").advice;
  };
  EXPECT_THAT(advice(-1.1e-3, -1.3e-3, -1.4e-3), ::testing::HasSubstr("(--gravity)"));
  EXPECT_THAT(advice(-1.1e-3, -1.3e-3, 0), ::testing::Not(::testing::HasSubstr("--gravity")));
  EXPECT_THAT(advice(0.02, 0.02, 0.02), ::testing::Not(::testing::HasSubstr("--gravity")))
      << "no place on Earth has that";
}

TEST(FaultRules, APosesChangeIsToldInTheUnitOfEachComponent) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  FaultTest test;
  test.fault = UnmodelledFault::kImuMoved;
  test.estimate = Eigen::VectorXd::Zero(6);
  test.std = Eigen::VectorXd::Constant(6, 1e-4);
  FaultDiagnosis& faults = diagnosisIn(record, 3e-4);
  const auto evidence = [&] {
    faults.tests = faults.causes = {test};
    return findingOf(judge(record), "Unmodelled fault").evidence;
  };
  test.estimate(4) = 3.5e-3;
  EXPECT_THAT(evidence(), ::testing::StartsWith("change of T_SC0: ry +3.5 mrad (+- 0.1);"));
  test.estimate(0) = 2e-3;
  test.estimate(1) = -1e-3;
  EXPECT_THAT(
      evidence(),
      ::testing::StartsWith("change of T_SC0: tx +2, ty -1 mm, ry +3.5 mrad (+- 0.1, 0.1, 0.1);"));
}

}  // namespace
}  // namespace plumbline
