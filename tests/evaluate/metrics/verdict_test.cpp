// SPDX-License-Identifier: BSD-3-Clause
// The verdict on results made up to sit on either side of each rule.
#include "evaluate/metrics/verdict.h"

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluate/metrics/coverage.h"
#include "evaluate/metrics/headline.h"
#include "tests/evaluate/metrics/verdict_records.h"

namespace plumbline {
namespace {

using ::testing::EndsWith;

using test::cameraRecord;
using test::findingOf;
using test::levelOf;

TEST(Verdict, IsGoodForAGoodRecording) {
  const Verdict verdict = judge(cameraRecord(0.3, 0.8));
  EXPECT_EQ(verdict.level, VerdictLevel::kGood);
  for (const Finding& finding : verdict.findings) {
    EXPECT_FALSE(finding.evidence.empty()) << finding.rule;
    EXPECT_TRUE(finding.advice.empty()) << finding.rule;
  }
}

TEST(Verdict, WorstFindingDecides) {
  const Verdict verdict = judge(cameraRecord(3.0, 0.3));
  EXPECT_EQ(levelOf(verdict, "Reprojection"), VerdictLevel::kBad);
  EXPECT_EQ(levelOf(verdict, "Tilt"), VerdictLevel::kCaution);
  EXPECT_EQ(verdict.level, VerdictLevel::kBad);
  for (const Finding& finding : verdict.findings) {
    EXPECT_EQ(finding.advice.empty(), finding.level == VerdictLevel::kGood) << finding.rule;
  }
}

TEST(Verdict, FewFrontalViewsAreBad) {
  const Verdict verdict = judge(cameraRecord(0.3, 0.0, 5));
  EXPECT_EQ(levelOf(verdict, "Views of cam0"), VerdictLevel::kBad);
  EXPECT_EQ(levelOf(verdict, "Tilt"), VerdictLevel::kBad);
}

// Views that a selection left out need not be recorded anew; those of another camera do not count.
TEST(Verdict, OfSelectedViewsTheSelectionIsNamed) {
  CalibrationRecord record = cameraRecord(0.3, 0.0, 5);
  const auto advice = [&record](const std::string& rule = "Views of cam0") {
    for (const Finding& finding : judge(record).findings) {
      if (finding.rule == rule) return finding.advice;
    }
    return std::string();
  };
  record.assumptions.views_selected = true;
  EXPECT_EQ(advice().find("--select-views"), std::string::npos) << "there are no others";
  record.counts.resize(1);
  record.counts[0].views_with_corners = 1416;
  const std::string note =
      "Of 1416 views with corners 5 are used; a smaller value of --select-views, or none, takes "
      "more.";
  EXPECT_EQ(advice(), note +
                          " Standard deviations from residuals, and the comparison of halves, are "
                          "uncertain of so few views.");
  EXPECT_EQ(levelOf(judge(record), "Views of cam0"), VerdictLevel::kBad) << "few all the same";
  record.counts[0].views_with_corners = 12;
  EXPECT_THAT(advice(), EndsWith("Where that does not help: Record more views, differing in "
                                 "distance, tilt and position."))
      << "all of them are few, too";
  record.counts[0].views_with_corners = 1416;
  EXPECT_EQ(advice("Tilt of the views"),
            "Tilt the rig (or the target) by 30 to 45 degrees: frontal views do not separate focal "
            "length from distance. " +
                note);
  record.counts.push_back(record.counts[0]);
  record.counts[0].views_with_corners = 5;
  EXPECT_EQ(advice().find("--select-views"), std::string::npos) << advice();
  EXPECT_NE(advice("Tilt of the views").find("Of 1421 views with corners 5"), std::string::npos);
  record.assumptions.views_selected = false;
  EXPECT_EQ(advice().find("Record more views"), 0U) << advice();
}

TEST(Verdict, SystematicErrorIsSeenThroughASmallRmse) {
  CalibrationRecord record = cameraRecord(0.1, 0.8, 120);
  for (CornerResidual& residual : record.camera->residuals) {
    if (residual.corner_id == 0) residual.error = {1.5F, 0.0F};  // one image region is off
  }
  EXPECT_EQ(levelOf(judge(record), "Systematic"), VerdictLevel::kCaution);
}

TEST(Verdict, NotANumberIsBad) {
  EXPECT_EQ(judge(cameraRecord(std::nan(""), 0.8)).level, VerdictLevel::kBad);
}

TEST(Verdict, ResampledSpreadOverrulesAFormalDeviation) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  auto& covariance = record.camera->summary.covariance;
  covariance.names = {"cam0.fu"};
  covariance.units = {"px"};
  covariance.matrix = Eigen::MatrixXd::Constant(1, 1, 0.01);
  EXPECT_EQ(levelOf(judge(record), "Focal length"), VerdictLevel::kGood);
  record.camera_resample = ResampleSpread{20, 0, {"cam0.fu"}, Eigen::VectorXd::Constant(1, 4.5)};
  const Verdict verdict = judge(record);
  EXPECT_EQ(levelOf(verdict, "Focal length"), VerdictLevel::kCaution);
}

TEST(Verdict, ABootstrapWithoutASpreadIsACautionOfItsStage) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  record.camera_resample = ResampleSpread{10, 9, {}, {}};
  const Verdict verdict = judge(record);
  EXPECT_EQ(levelOf(verdict, "Bootstrap"), VerdictLevel::kCaution);
  EXPECT_THAT(findingOf(verdict, "Bootstrap (cameras)").evidence, ::testing::HasSubstr("9 of 10"));
  record.camera_resample->failed = 10;
  EXPECT_EQ(levelOf(judge(record), "Bootstrap"), VerdictLevel::kCaution);
  record.camera_resample = ResampleSpread{10, 1, {"cam0.fu"}, Eigen::VectorXd::Constant(1, 0.1)};
  for (const Finding& finding : judge(record).findings) {
    EXPECT_EQ(finding.rule.find("Bootstrap"), std::string::npos);
  }
}

TEST(Verdict, ABootstrapOfFewDrawsIsARoughFigure) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  const auto finding = [&](int draws, int failed) {
    record.camera_resample =
        ResampleSpread{draws, failed, {"cam0.fu"}, Eigen::VectorXd::Constant(1, 0.1)};
    return findingOf(judge(record), "Bootstrap (cameras)");
  };
  EXPECT_TRUE(isNotJudged(finding(10, 8)));
  EXPECT_THAT(finding(10, 8).evidence,
              ::testing::HasSubstr("of 2 draws of 10 (the others have no solution), from which it "
                                   "is known to +- 71 % only"));
  EXPECT_TRUE(isNotJudged(finding(8, 0)));
  EXPECT_THAT(finding(3, 0).evidence, ::testing::HasSubstr("of 3 draws, from which it is known to "
                                                           "+- 50 % only"));
}

TEST(Verdict, DensitiesAreJudgedWhereResidualsSayEnough) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  record.camera_imu = CameraImuStageResult();
  ImuNoiseCheck& gyro = record.camera_imu->imu_summary.noise.gyro;
  const auto levelAt = [&](double factor) {
    gyro = {0.5, factor, 60};
    return levelOf(judge(record), "Noise density of the gyroscope");
  };
  EXPECT_EQ(levelAt(1.9), VerdictLevel::kGood);
  EXPECT_EQ(levelAt(2.1), VerdictLevel::kCaution);
  EXPECT_EQ(levelAt(11), VerdictLevel::kBad);
  EXPECT_EQ(levelAt(0.21), VerdictLevel::kGood);
  EXPECT_EQ(levelAt(0.001), VerdictLevel::kCaution);  // cautious, never bad
  gyro = {0.5, 11, 40};
  for (const Finding& finding : judge(record).findings) {
    EXPECT_EQ(finding.rule.find("Noise density"), std::string::npos);
  }
}

// What was not judged is good, as nothing speaks against it, and no rule that is met.
TEST(Verdict, CountsNoRuleAsMetThatCouldNotBeJudged) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  record.verdict = judge(record);
  EXPECT_THAT(calibrationHeadline(record),
              ::testing::AllOf(::testing::HasSubstr("; all "), ::testing::EndsWith(" are met.")));
  CameraImuStageResult& stage = record.camera_imu.emplace();
  stage.frames.push_back({0, {0}});
  stage.summary = record.camera->summary;
  FaultTest size;  // which the motion hardly tells
  size.fault = UnmodelledFault::kTargetSize;
  size.estimate = Eigen::VectorXd::Constant(1, 0.001);
  size.std = Eigen::VectorXd::Constant(1, 0.2);
  FaultDiagnosis& faults = stage.faults.emplace();
  faults.formal_std.setConstant(1e-3);
  faults.tests = {size};
  record.verdict = judge(record);
  ASSERT_EQ(record.verdict.level, VerdictLevel::kGood) << worstFinding(record.verdict);
  const std::string text = verdictText(record.verdict);
  EXPECT_THAT(text, ::testing::HasSubstr(
                        "  not judged - Size of the target by the batch: the motion tells"));
  EXPECT_THAT(calibrationHeadline(record),
              ::testing::AllOf(::testing::HasSubstr("not judged: Size of the target by the batch;"),
                               ::testing::HasSubstr("scale rests on the stated size of the target"),
                               ::testing::Not(::testing::HasSubstr("all "))));
  // Cameras alone never test it; of one camera nothing has a length.
  record.camera_imu.reset();
  record.camera->cameras.push_back(record.camera->cameras.front());
  EXPECT_THAT(calibrationHeadline(record), ::testing::HasSubstr("scale rests on"));
}

TEST(Verdict, ASizeThatTheMotionHardlyTellsIsNotJudged) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  record.camera_imu.emplace().frames.push_back({0, {0}});
  FaultDiagnosis& faults = record.camera_imu->faults.emplace();
  faults.formal_std.setConstant(1e-3);
  FaultTest test;
  test.fault = UnmodelledFault::kTargetSize;
  const auto sizeOf = [&](double off, double std) {
    test.estimate = Eigen::VectorXd::Constant(1, off);
    test.std = Eigen::VectorXd::Constant(1, std);
    faults.tests = {test};
    record.verdict = judge(record);
    return findingOf(record.verdict, "Size of the target by the batch");
  };
  EXPECT_FALSE(isNotJudged(sizeOf(0.001, 0.002)));
  EXPECT_THAT(calibrationHeadline(record), ::testing::Not(::testing::HasSubstr("scale rests on")));
  EXPECT_TRUE(isNotJudged(sizeOf(0.02, 0.02))) << "three per cent would stay unseen";
  EXPECT_TRUE(isNotJudged(sizeOf(-0.54, 0.07))) << "beyond the linear range";
  // By the linear fit, where no fault was tested.
  record.camera_imu->faults.reset();
  const auto fit = [&](double std) {
    record.camera_imu->inertial_check = {1.001, std, 9.80665, 1.0};
    return findingOf(judge(record), "Scale by the linear fit");
  };
  EXPECT_FALSE(isNotJudged(fit(0.004)));
  EXPECT_TRUE(isNotJudged(fit(0.1)));
}

TEST(Verdict, LinearFitIsJudgedOnlyWhereFaultsWereNotTestedAndNamesNoCause) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  CameraImuStageResult stage;
  stage.frames.push_back({0, {0}});
  stage.inertial_check = {1.08, 0.006, 9.5, 1.0};
  record.camera_imu = stage;
  const Verdict untested = judge(record);
  for (const char* rule : {"Scale by the linear fit", "Gravity by the linear fit"}) {
    EXPECT_EQ(levelOf(untested, rule), VerdictLevel::kCaution);
  }
  record.camera_imu->inertial_check.target_scale_std = std::nan("");
  EXPECT_EQ(levelOf(judge(record), "Scale by the linear fit"), VerdictLevel::kCaution);
  for (const Finding& finding : untested.findings) {
    EXPECT_EQ(finding.advice.find("Measure the target again"), std::string::npos);
  }
  record.camera_imu->faults.emplace();
  for (const Finding& finding : judge(record).findings) {
    EXPECT_EQ(finding.rule.find("by the linear fit"), std::string::npos) << finding.evidence;
  }
}

TEST(Verdict, CamerasThatAreNotSynchronisedAreNamedWithTheirOffsets) {
  CalibrationRecord record = cameraRecord(0.3, 0.5);
  record.camera_imu = CameraImuStageResult();
  CameraCalibration cam0, cam1;
  cam0.name = "cam0";
  cam1.name = "cam1";
  record.camera_imu->cameras = {cam0, cam1};
  const std::string rule = "Cameras exposed together";
  for (const Finding& finding : judge(record).findings) EXPECT_NE(finding.rule, rule);
  record.camera_imu->imu.time_offsets = {{1e-3}, {1.4e-3, true}};
  EXPECT_EQ(levelOf(judge(record), rule), VerdictLevel::kGood);
  record.camera_imu->imu.time_offsets = {{1e-3}, {-2e-3, true}};
  EXPECT_EQ(levelOf(judge(record), rule), VerdictLevel::kCaution);
  EXPECT_DOUBLE_EQ(findingOf(judge(record), rule).value, 3);
  EXPECT_THAT(findingOf(judge(record), rule).evidence, ::testing::HasSubstr("cam1 -2.0000"));
  // Two that are further from each other than either is from the first.
  record.camera_imu->cameras.resize(3);
  record.camera_imu->imu.time_offsets = {{1e-3}, {1.6e-3, true}, {0.4e-3, true}};
  EXPECT_EQ(levelOf(judge(record), rule), VerdictLevel::kCaution);
  EXPECT_NEAR(findingOf(judge(record), rule).value, 1.2, 1e-9);
}

TEST(Verdict, TheOffsetOfEveryCameraIsJudged) {
  CalibrationRecord record = cameraRecord(0.3, 0.5);
  CameraImuStageResult& stage = record.camera_imu.emplace();
  stage.cameras.resize(2);
  stage.cameras[1].name = "cam2";  // the second of --only cam0,cam2
  stage.imu.time_offsets = {{1e-3}, {2e-3, true}};
  auto& covariance = stage.summary.covariance;
  covariance.names = {"T_SC0.tx", "T_SC0.rx", "time_offset", "time_offset.cam2"};
  covariance.units = {"m", "rad", "s", "s"};
  covariance.matrix = Eigen::Vector4d(1e-8, 1e-8, 1e-10, 1e-6).asDiagonal();
  const Finding finding = findingOf(judge(record), "Time offset");
  EXPECT_EQ(finding.level, VerdictLevel::kCaution);
  EXPECT_DOUBLE_EQ(finding.value, 1);
  EXPECT_THAT(finding.evidence, ::testing::HasSubstr("of the time offset of cam2 is 1.0000 ms"));
  // The headline of a good result states the same one.
  record.verdict = {};
  EXPECT_THAT(calibrationHeadline(record), ::testing::HasSubstr("time offset to 1 ms"));
}

TEST(Verdict, ABoardWithoutASolutionIsNotCalledATooShortRecording) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  record.camera->target_fit = TargetFit{};
  EXPECT_EQ(findingOf(judge(record), "Shape of the target").level, VerdictLevel::kCaution);
  record.camera->target_fit->shape.covariance = TargetCovariance::Identity();
  EXPECT_EQ(findingOf(judge(record), "Shape of the target").level, VerdictLevel::kGood);
}

TEST(Verdict, RegionsWithFewCornersSayNothingOfASystematicError) {
  for (const Finding& finding : judge(cameraRecord(0.3, 0.8)).findings) {
    EXPECT_EQ(finding.rule.find("Systematic"), std::string::npos);  // 40 corners each
  }
}

TEST(Verdict, ADeviationThatIsNotANumberIsBad) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  auto& summary = record.camera->summary;
  summary.covariance.names = {"cam0.fu"};
  summary.covariance.units = {"px"};
  summary.covariance.matrix = Eigen::MatrixXd::Constant(1, 1, 0.01);
  summary.robust_std = Eigen::VectorXd::Constant(1, std::nan(""));
  EXPECT_EQ(levelOf(judge(record), "Focal length"), VerdictLevel::kBad);
}

TEST(Verdict, WithoutACovarianceTheExtrinsicsAreNotJudged) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  record.camera_imu = CameraImuStageResult();
  for (const Finding& finding : judge(record).findings) {
    EXPECT_EQ(finding.rule.find("Lever arm"), std::string::npos);
  }
}

TEST(Verdict, ThresholdsAreOptions) {
  VerdictThresholds thresholds;
  thresholds.rmse_px = {0.1, 0.2};
  EXPECT_EQ(judge(cameraRecord(0.3, 0.8), thresholds).level, VerdictLevel::kBad);
}

TEST(RegionalErrors, CountsRegionsWithCorners) {
  const CalibrationRecord record = cameraRecord(0.3, 0.8, 2);
  const RegionalErrors all = regionalErrors(record.camera->residuals, 0, {800, 600});
  EXPECT_DOUBLE_EQ(all.coverage(), 1.0);
  EXPECT_DOUBLE_EQ(all.coverage(3), 0.0);
  // Twice the width: the same corners reach the left half only.
  EXPECT_DOUBLE_EQ(regionalErrors(record.camera->residuals, 0, {1600, 600}).coverage(), 0.5);
}

}  // namespace
}  // namespace plumbline
