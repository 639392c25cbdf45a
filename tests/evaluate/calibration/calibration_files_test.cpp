// SPDX-License-Identifier: BSD-3-Clause
// The documents of a calibration, and what a request for one may ask.
#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/simulate/rig.h"
#include "evaluate/calibration/calibrate_session.h"
#include "evaluate/calibration/export_calibration.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// One frame that both cameras of a rig saw, and with an IMU another one.
CalibrationRecord recordOf(bool with_imu) {
  const Calibration truth = simulatedRig("euroc").calibration;
  CalibrationRecord record;
  CameraStageResult& cameras = record.camera.emplace();
  cameras.cameras = truth.cameras;
  cameras.frames = {{1'400'000'000'000'000'001, {0, 0}}};
  cameras.residuals = {{0, 0, 17, {100.5F, 200.25F}, {0.125F, -0.5F}, true},
                       {1, 0, 18, {300, 400}, {3, -4}, false}};
  if (!with_imu) return record;
  CameraImuStageResult& stage = record.camera_imu.emplace();
  stage.cameras = truth.cameras;
  stage.imu = *truth.imu;
  stage.frames = {{7, {0, 0}}, {8, {1, 1}}};
  stage.residuals = {{1, 1, 3, {1, 2}, {0.25F, 0}, true}};
  return record;
}

std::vector<std::string> namesOf(const std::vector<ResultFile>& files) {
  std::vector<std::string> names;
  for (const ResultFile& file : files) names.push_back(file.name);
  return names;
}

TEST(CalibrationFiles, AreThoseOfWhatWasCalibrated) {
  EXPECT_THAT(namesOf(calibrationFiles(recordOf(false), false)),
              ElementsAre("calibration.json", "camchain.yaml"));
  CalibrationRecord record = recordOf(true);
  EXPECT_THAT(namesOf(calibrationFiles(record, false)),
              ElementsAre("calibration.json", "camchain-imucam.yaml", "imu.yaml"));
  record.target.shape.terms[0] = 1e-3;
  EXPECT_THAT(namesOf(calibrationFiles(record, true)),
              ElementsAre("calibration.json", "camchain-imucam.yaml", "imu.yaml",
                          "target_shape.yaml", "residuals.csv"));
}

TEST(CalibrationFiles, ResidualsHaveTheStampAndTheCameraOfTheirOwnStage) {
  const auto files = calibrationFiles(recordOf(true), true);
  EXPECT_EQ(files.back().text,
            "#stage,timestamp [ns],camera,corner_id,u [px],v [px],e_u [px],e_v [px],used\n"
            "camera,1400000000000000001,cam0,17,100.500000,200.250000,0.125000,-0.500000,1\n"
            "camera,1400000000000000001,cam1,18,300.000000,400.000000,3.000000,-4.000000,0\n"
            "camera_imu,8,cam1,3,1.000000,2.000000,0.250000,0.000000,1\n");
}

std::string refusalOf(auto change) {
  CalibrateRequest request;
  change(request);
  try {
    request.check();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(CalibrateRequest, NamesWhatCannotBeAskedFor) {
  EXPECT_EQ(refusalOf([](auto& r) { r.resamples = 2; }), "");
  EXPECT_THAT(refusalOf([](auto& r) { r.resamples = 1; }), HasSubstr("1 bootstrap solutions"));
  EXPECT_THAT(refusalOf([](auto& r) { r.resamples = -1; }), HasSubstr("-1 bootstrap solutions"));
  EXPECT_THAT(refusalOf([](auto& r) { r.free_cameras = true; }), HasSubstr("only if a file"));
  const auto given = [](bool free, bool imu) {
    return refusalOf([&](auto& r) {
      r.cameras_file = "camchain.yaml";
      r.free_cameras = free;
      r.use_imu = imu;
    });
  };
  EXPECT_THAT(given(false, false), HasSubstr("nothing to estimate"));
  EXPECT_EQ(given(true, false), "");
  EXPECT_EQ(given(false, true), "");
}

std::string textOf(const CalibrationExport& out, const std::string& ending) {
  for (const auto& file : out.files) {
    if (file.name.ends_with(ending)) return file.text;
  }
  return "";
}

// Kalibr's imu.yaml brings the densities, and its topic if it names one.
TEST(ExportCalibration, TheNoiseIsThatOfTheFileGiven) {
  const TemporaryFolder folder;
  CalibrationRecord record = recordOf(true);
  record.camera_imu->imu.rostopic = "/imu_of_ours";
  ExportRequest request;
  request.calibration = folder.write("calibration.json", calibrationFiles(record, false)[0].text);
  const std::string densities =
      "accelerometer_noise_density: 0.0625\naccelerometer_random_walk: 0.03125\n"
      "gyroscope_noise_density: 0.015625\ngyroscope_random_walk: 0.0078125\nupdate_rate: 400.0\n";
  request.imu = folder.write("imu.yaml", densities);
  const std::string unnamed = textOf(exportCalibrationFile(request), "imu.yaml");
  EXPECT_THAT(unnamed, HasSubstr("gyroscope_noise_density: 0.015625"));
  EXPECT_THAT(unnamed, HasSubstr("/imu_of_ours"));
  request.imu = folder.write("imu.yaml", densities + "rostopic: /imu_of_theirs\n");
  EXPECT_THAT(textOf(exportCalibrationFile(request), "imu.yaml"), HasSubstr("/imu_of_theirs"));
  request.calibration =
      folder.write("cameras.json", calibrationFiles(recordOf(false), false)[0].text);
  try {
    (void)exportCalibrationFile(request);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("cameras.json: has no IMU whose noise"));
  }
}

}  // namespace
}  // namespace plumbline
