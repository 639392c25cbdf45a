// SPDX-License-Identifier: BSD-3-Clause
// What a person reads of scores and results: each number stands with the camera, and the name, that
// it belongs to.
#include <limits>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluate/calibration/calibrate_session.h"
#include "evaluate/calibration/evaluate_calibration.h"
#include "tests/report/calibration_scores.h"

namespace plumbline {
namespace {

using test::scoreOf;
using ::testing::ElementsAre;

std::vector<std::string> wordsOf(const std::string& line) {
  std::istringstream stream(line);
  return {std::istream_iterator<std::string>(stream), {}};
}

TEST(EvaluationSummary, LooksCamerasUpByName) {
  CalibrationRecord record;
  record.held = HeldCalibration();
  record.held->file = "rig.yaml";
  record.held->scores = {scoreOf("a", {{"left", 1}, {"right", 2}}),
                         scoreOf("b", {{"right", 4}, {"left", 3}}), scoreOf("c", {{"right", 5}})};
  std::istringstream text(evaluationSummary(record));
  std::vector<std::vector<std::string>> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(wordsOf(line));
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_THAT(lines[1], ElementsAre("RMSE", "[px]", "all", "left", "right", "with", "IMU",
                                    "corners", "views"));
  EXPECT_THAT(lines[2], ElementsAre("a", "9.0000", "1.0000", "2.0000", "-", "10", "0"));
  EXPECT_THAT(lines[3], ElementsAre("b", "9.0000", "3.0000", "4.0000", "-", "10", "0"));
  EXPECT_THAT(lines[4], ElementsAre("c", "9.0000", "-", "5.0000", "-", "10", "0"));
}

/// Two pinholes without distortion: four parameters each.
CameraStageResult twoCameras() {
  CameraStageResult stage;
  for (int c = 0; c < 2; ++c) {
    CameraCalibration camera;
    camera.name = "cam" + std::to_string(c);
    camera.intrinsics.projection = Eigen::Vector4d(400 + c, 401 + c, 320, 240);
    camera.intrinsics_std = Eigen::Vector4d::Constant(0.5 + c);
    stage.cameras.push_back(camera);
  }
  return stage;
}

TEST(CalibrationSummary, ACamerasDeviationsAreRobustWithTheFormalOnesBesideThem) {
  CalibrationRecord record;
  record.camera = twoCameras();
  record.camera->summary.robust_std = Eigen::VectorXd::LinSpaced(14, 1, 14);
  const std::string text = calibrationSummary(record);
  EXPECT_THAT(text, ::testing::HasSubstr("std [1, 2, 3, 4] (robust)\n       formal std [0.5, "));
  EXPECT_THAT(text, ::testing::HasSubstr("std [5, 6, 7, 8] (robust)\n       formal std [1.5, "));
}

// A joint camera-IMU stage has estimated the cameras again: those of the camera stage are of
// another result.
TEST(CalibrationSummary, CamerasOfAJointStageHaveItsDeviationsAlone) {
  CalibrationRecord record;
  record.camera = twoCameras();
  record.camera->summary.robust_std = Eigen::VectorXd::LinSpaced(14, 1, 14);
  record.camera_imu = CameraImuStageResult();
  record.camera_imu->cameras = record.camera->cameras;
  std::vector<std::string>& names = record.camera_imu->summary.covariance.names;
  names = {"T_SC0.tx", "time_offset", "cam0.fu", "cam1.fu"};
  EXPECT_THAT(calibrationSummary(record), ::testing::Not(::testing::HasSubstr("std [1, 2")));
  record.camera_imu->summary.robust_std = Eigen::VectorXd::LinSpaced(10, 21, 30);
  const std::string text = calibrationSummary(record);
  EXPECT_THAT(text, ::testing::HasSubstr("std [23, 24, 25, 26] (robust)"));
  EXPECT_THAT(text, ::testing::HasSubstr("std [27, 28, 29, 30] (robust)"));
  record.camera_imu->summary.robust_std.reset();
  names = {"T_SC0.tx", "time_offset", "time_offset.cam1"};  // cameras held, with their own offsets
  EXPECT_THAT(calibrationSummary(record), ::testing::HasSubstr("std [1, 2, 3, 4] (robust)"));
}

TEST(CalibrationSummary, WithoutRobustDeviationsTheFormalOnesAreNamedSo) {
  CalibrationRecord record;
  record.camera = twoCameras();
  const std::string text = calibrationSummary(record);
  EXPECT_THAT(text, ::testing::Not(::testing::HasSubstr("robust")));
  EXPECT_THAT(text, ::testing::HasSubstr("       formal std [0.5, 0.5, 0.5, 0.5]\n"));
}

using ::testing::HasSubstr;
using ::testing::Not;

CalibrationRecord withImu() {
  CalibrationRecord record;
  CameraImuStageResult& stage = record.camera_imu.emplace();
  stage.imu.T_SC0.t << 0.0625, -0.125, 0.0005;
  stage.imu.T_SC0_std = (Vector6d() << 1e-3, 2e-3, 3e-3, 1e-3, 2e-3, 3e-3).finished();
  stage.imu.time_offsets = {{-0.00375}};
  stage.imu.time_offset_std_s = 1.25e-5;
  stage.frames.resize(3);
  return record;
}

// 1e-3 rad are 0.0573 degrees.
TEST(CalibrationSummary, TheImusPartIsInMillimetresDegreesAndMilliseconds) {
  CalibrationRecord record = withImu();
  EXPECT_THAT(calibrationSummary(record),
              HasSubstr("  T_SC0 translation [62.50, -125.00, 0.50] mm, std [1.00, 2.00, 3.00] mm, "
                        "[0.0573, 0.1146, 0.1719] deg\n"
                        "  time offset -3.7500 ms, std 0.0125 ms (t_imu = t_cam + offset)\n"));
  record.camera_imu->summary.robust_std =
      (Eigen::VectorXd(7) << 4e-3, 5e-3, 6e-3, 0, 0, 0, 2.5e-5).finished();
  EXPECT_THAT(calibrationSummary(record),
              AllOf(HasSubstr("std [4.00, 5.00, 6.00] mm, [0.0000, 0.0000, 0.0000] deg (robust, "
                              "through both stages); formal [1.00, 2.00, 3.00] mm"),
                    HasSubstr("-3.7500 ms, std 0.0250 ms; formal 0.0125 ms (t_imu")));
  // With the cameras in the same batch there is one stage.
  record.camera_imu->cameras = twoCameras().cameras;
  record.camera_imu->summary.covariance.names = {"T_SC0.tx", "cam0.fu"};
  record.camera_imu->summary.robust_std = Eigen::VectorXd::Constant(14, 4e-3);
  EXPECT_THAT(calibrationSummary(record), HasSubstr("deg (robust); formal [1.00"));
}

TEST(CalibrationSummary, WhatTheImuStageLeftOutIsCounted) {
  CalibrationRecord record = withImu();
  EXPECT_THAT(calibrationSummary(record), Not(HasSubstr("not used")));
  record.camera_imu->frames_without_imu = 5;
  record.camera_imu->frames_without_pose = 7;
  record.camera_imu->imu_gaps = 2;
  EXPECT_THAT(calibrationSummary(record),
              HasSubstr("3 frames used; not used: 5 without IMU samples, 7 without a pose; gaps in "
                        "the IMU: 2\n"));
  EXPECT_THAT(calibrationSummary(CalibrationRecord()), HasSubstr("Camera-IMU: not calibrated"));
}

TEST(CalibrationSummary, TheBoardIsToldByWhatWasFoundOfIt) {
  CalibrationRecord record;
  record.camera = twoCameras();
  TargetFit& fit = record.camera->target_fit.emplace();
  fit.finding = TargetFinding::kKnown;
  EXPECT_THAT(calibrationSummary(record), HasSubstr("known from another session; not tested"));
  fit.finding = TargetFinding::kBent;
  fit.shape.terms[8] = 1.5e-3;  // z_xx, of unit RMS
  fit.held_out_px = 0.25;
  fit.flat_held_out_px = 0.5;
  EXPECT_THAT(calibrationSummary(record),
              HasSubstr("1.50 mm RMS deviation from the even grid, not applied; held-out frames "
                        "0.2500 px with the estimated shape, 0.5000 px without"));
  record.camera->target.terms = fit.shape.terms;
  EXPECT_THAT(calibrationSummary(record), HasSubstr("even grid, estimated with the cameras;"));
}

TEST(CalibrationSummary, FarPointsAreKnownByMedianAndLargestOfTheImage) {
  CalibrationRecord record;
  record.camera = twoCameras();
  ImageMap map;
  map.camera = "cam1";
  map.values = {0.5, std::numeric_limits<double>::quiet_NaN(), 0.25, 2};
  record.projection_uncertainty = {map};
  EXPECT_THAT(calibrationSummary(record),
              HasSubstr("cam1 projection of far points: std 0.5 px in the median, 2 px at most"));
}

}  // namespace
}  // namespace plumbline
