// SPDX-License-Identifier: BSD-3-Clause
// What a person reads of scores and results: each number stands with the camera, and the name, that
// it belongs to.
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

// A joint camera-IMU stage has estimated the cameras again: robust deviations are of another
// result.
TEST(CalibrationSummary, CamerasOfAJointStageHaveTheirOwnDeviationsAlone) {
  CalibrationRecord record;
  record.camera = twoCameras();
  record.camera->summary.robust_std = Eigen::VectorXd::LinSpaced(14, 1, 14);
  record.camera_imu = CameraImuStageResult();
  record.camera_imu->cameras = record.camera->cameras;
  std::vector<std::string>& names = record.camera_imu->summary.covariance.names;
  names = {"T_SC0.tx", "time_offset", "cam0.fu", "cam1.fu"};
  EXPECT_THAT(calibrationSummary(record), ::testing::Not(::testing::HasSubstr("std [1, 2")));
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

}  // namespace
}  // namespace plumbline
