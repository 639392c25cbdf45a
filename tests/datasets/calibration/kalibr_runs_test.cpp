// SPDX-License-Identifier: BSD-3-Clause
// Which of a folder's files are of one run of Kalibr.
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/calibration/kalibr/run.h"
#include "tests/datasets/calibration/kalibr_texts.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

/// The camera tool's camchain of kCamchainImuYaml, with this focal length.
std::string cameraChain(const std::string& fu) {
  std::string text = kCamchainImuYaml;
  text.erase(text.find("  T_cam_imu"), text.find("  camera_model") - text.find("  T_cam_imu"));
  text.erase(text.find("  timeshift"));
  return text.replace(text.find("400.0"), 5, fu);
}

TEST(KalibrRuns, FilesAreKnownByContentNotByName) {
  const TemporaryFolder folder;
  using Kind = KalibrFileKind;
  EXPECT_EQ(kalibrFileKind(folder.write("1", kCamchainImuYaml)), Kind::kCamchainImu);
  EXPECT_EQ(kalibrFileKind(folder.write("2", kImuYaml)), Kind::kImu);
  EXPECT_EQ(kalibrFileKind(folder.write("3", kCamText)), Kind::kResultsCameras);
  EXPECT_EQ(kalibrFileKind(folder.write("4", kImuText)), Kind::kResultsImu);
  EXPECT_EQ(kalibrFileKind(folder.write("5", kPosesHeader)), Kind::kPoses);
  EXPECT_EQ(kalibrFileKind(folder.write("6", "target_type: aprilgrid\n")), std::nullopt);
  EXPECT_EQ(kalibrFileKind(folder.write("7", "%YAML:1.0\n---\nimu: 1\n")), std::nullopt);
  // The IMU at the second camera alone.
  std::string first = kCamchainImuYaml, second = kCamchainImuYaml;
  first.replace(first.find("T_cam_imu"), 9, "T_other");
  second.replace(0, 4, "cam1");
  EXPECT_EQ(kalibrFileKind(folder.write("8", first)), Kind::kCamchain);
  EXPECT_EQ(kalibrFileKind(folder.write("9", first + second)), Kind::kCamchainImu);
  EXPECT_EQ(kalibrFileKind(folder.path("missing")), std::nullopt);
}

TEST(KalibrRuns, WhatBelongsTogetherIsGathered) {
  const TemporaryFolder folder;
  const std::string chain = folder.write("a", kCamchainImuYaml);
  const std::string text = folder.write("b", kImuText);
  folder.write("c", kImuYaml);
  // An IMU of another recording, and the text of another run.
  folder.write("d",
               std::string(kImuYaml).replace(std::string(kImuYaml).find("0.00017"), 7, "0.00099"));
  folder.write("e", std::string(kImuText).replace(std::string(kImuText).find("0.05]"), 5, "0.09]"));
  for (const std::string& path : {folder.path(), chain, text}) {
    const KalibrRun run = readKalibrRun(path);
    const Calibration calibration = run.calibration();
    EXPECT_EQ(calibration.imu->noise.gyro_density, 0.00017);
    EXPECT_EQ(calibration.imu->rostopic, "/imu0");
    EXPECT_DOUBLE_EQ(calibration.imu->gravity_m_s2, Eigen::Vector3d(0.6, -9.7, 0.8).norm());
    ASSERT_TRUE(run.results());
    EXPECT_EQ(run.results()->path, text);
    ASSERT_EQ(run.remarks.size(), 1U);
    EXPECT_THAT(run.remarks[0], HasSubstr("does not have the values"));
  }
}

// Kalibr writes imu.yaml with imu0: at its top, what its user wrote is flat. Without a results text
// the form alone tells which of the two is the run's.
TEST(KalibrRuns, TheImuThatKalibrWroteGoesBeforeItsInput) {
  const TemporaryFolder folder;
  const std::string chain = folder.write("camchain.yaml", kCamchainImuYaml);
  folder.write("a.yaml",
               "accelerometer_noise_density: 0.009\naccelerometer_random_walk: 0.003\n"
               "gyroscope_noise_density: 0.00017\ngyroscope_random_walk: 2.0e-05\n"
               "rostopic: /imu0\nupdate_rate: 200.0\n");
  EXPECT_EQ(readKalibrRun(chain).calibration().imu->noise.accel_density, 0.009);
  std::string result = kImuYaml;
  folder.write("b.yaml", result.replace(result.find("0.002"), 5, "0.004"));
  EXPECT_EQ(readKalibrRun(chain).calibration().imu->noise.accel_density, 0.004);
}

// Same densities, but the samples of a recording at another rate.
TEST(KalibrRuns, AnImuOfAnotherRateIsAnotherRecordings) {
  const TemporaryFolder folder;
  const std::string chain = folder.write("camchain.yaml", kCamchainImuYaml);
  folder.write("results.txt", kImuText);
  std::string imu = kImuYaml;
  folder.write("imu.yaml", imu.replace(imu.find("200.0"), 5, "400.0"));
  const KalibrRun run = readKalibrRun(chain);
  EXPECT_FALSE(run.imu);
  EXPECT_EQ(run.calibration().imu->noise.rate_hz, 200);  // as the text says
}

// The camera tool prints "projection: [p] +- [std]" and "distortion: [d] +- [std]"; ours stack the
// projection first.
TEST(KalibrRuns, DeviationsOfTheTextStandBesideTheirParameters) {
  const TemporaryFolder folder;
  std::string text = kCamText;
  text.erase(text.find("\tcam0"), text.find("\tcam1") - text.find("\tcam0"));
  text.replace(text.find("cam1 (/right)"), 4, "cam0");
  text.erase(text.find("\tbaseline"), text.find("Target conf") - text.find("\tbaseline"));
  folder.write("results.txt", text);
  std::string camchain = cameraChain("400.0");
  camchain.replace(camchain.find("400.0, 400.0"), 12, "400.0, 401.0");
  const auto camera =
      readKalibrRun(folder.write("camchain.yaml", camchain)).calibration().cameras[0];
  ASSERT_TRUE(camera.intrinsics_std);
  EXPECT_EQ(camera.intrinsics_std->head(4), Eigen::Vector4d(1, 2, 3, 4));
  EXPECT_EQ(camera.intrinsics_std->tail(4), Eigen::Vector4d::Constant(0.01));
}

TEST(KalibrRuns, ACopyOfATextIsSaidToBeOne) {
  const TemporaryFolder folder;
  folder.write("a", kCamchainImuYaml);
  const std::string text = folder.write("b", kImuText);
  folder.write("c", kImuText);
  const KalibrRun run = readKalibrRun(folder.path());
  ASSERT_TRUE(run.results());
  EXPECT_EQ(run.results()->path, text);
  ASSERT_EQ(run.remarks.size(), 1U);
  EXPECT_THAT(run.remarks[0], HasSubstr("c is left out: " + text + " has the same values"));
}

TEST(KalibrRuns, SeveralRunsInAFolderMustBeNamed) {
  const TemporaryFolder folder;
  const std::string first = folder.write("run1.yaml", kCamchainImuYaml);
  folder.write("run2.yaml", std::string(kCamchainImuYaml)
                                .replace(std::string(kCamchainImuYaml).find("400.0"), 5, "401.0"));
  EXPECT_EQ(faultOf([&] { (void)readKalibrRun(folder.path()); }), InputFault::kAmbiguous);
  EXPECT_EQ(readKalibrRun(first).calibration().cameras[0].intrinsics.projection(0), 400);
  const std::string twice = folder.path() + "//run2.yaml";
  EXPECT_EQ(readKalibrRun(twice).calibration().cameras[0].intrinsics.projection(0), 401);
}

TEST(KalibrRuns, ALinkThatLeadsNowhereIsNoFile) {
  const TemporaryFolder folder;
  folder.write("camchain.yaml", kCamchainImuYaml);
  std::filesystem::create_symlink("loop", folder.path("loop"));
  EXPECT_TRUE(readKalibrRun(folder.path()).camera_imu);
}

TEST(KalibrRuns, TheNamedCamchainDecides) {
  const TemporaryFolder folder;
  const std::string other = folder.write("a-camchain.yaml", cameraChain("401.0"));
  const std::string own = folder.write("b-camchain.yaml", cameraChain("400.0"));
  const std::string imu = folder.write("b-camchain-imucam.yaml", kCamchainImuYaml);
  const KalibrRun alone = readKalibrRun(other);
  EXPECT_EQ(alone.calibration().cameras[0].intrinsics.projection(0), 401);
  EXPECT_FALSE(alone.calibration().imu);
  ASSERT_EQ(alone.remarks.size(), 1U);
  EXPECT_THAT(alone.remarks[0], HasSubstr("b-camchain-imucam.yaml does not have the intrinsics"));
  for (const std::string& path : {own, imu}) {
    const KalibrRun run = readKalibrRun(path);
    ASSERT_TRUE(run.cameras && run.camera_imu) << path;
    EXPECT_EQ(run.cameras->path, own);
    EXPECT_EQ(run.camera_imu->path, imu);
  }
}

TEST(KalibrRuns, TwoFullRunsInAFolderAreToldApart) {
  const TemporaryFolder folder;
  for (const char* const run : {"400.0", "401.0"}) {
    folder.write(std::string(run) + "-camchain.yaml", cameraChain(run));
    std::string imu = kCamchainImuYaml;
    folder.write(std::string(run) + "-imucam.yaml", imu.replace(imu.find("400.0"), 5, run));
  }
  EXPECT_EQ(faultOf([&] { (void)readKalibrRun(folder.path()); }), InputFault::kAmbiguous);
  for (const char* const file : {"401.0-camchain.yaml", "401.0-imucam.yaml"}) {
    const KalibrRun run = readKalibrRun(folder.path(file));
    EXPECT_THAT(run.cameras->path, HasSubstr("401.0-camchain.yaml"));
    EXPECT_THAT(run.camera_imu->path, HasSubstr("401.0-imucam.yaml"));
  }
}

TEST(KalibrRuns, FilesOfOtherRunsThatDoNotParseAreLeftOut) {
  const TemporaryFolder folder;
  const std::string chain = folder.write("camchain.yaml", kCamchainImuYaml);
  folder.write("results.txt", std::string(kImuText).substr(0, 300));
  std::string imu = kImuYaml;
  folder.write("imu.yaml", imu.replace(imu.find("0.002"), 5, "-1"));
  folder.write("poses.csv", std::string(kPosesHeader) + "1,0,0,1,2,0,0,0\n");
  const KalibrRun run = readKalibrRun(chain);
  EXPECT_FALSE(run.imu || run.results_imu || run.poses);
  EXPECT_EQ(run.remarks.size(), 4U);  // each file, and that no imu.yaml belongs to it
  EXPECT_THAT(run.remarks[0], HasSubstr("results.txt"));
}

TEST(KalibrRuns, FoldersWithoutACamchainAreRefused) {
  const TemporaryFolder folder;
  folder.write("imu.yaml", kImuYaml);
  EXPECT_EQ(faultOf([&] { (void)readKalibrRun(folder.path()); }), InputFault::kUnknownFile);
  const std::string other = folder.write("target.yaml", "target_type: aprilgrid\n");
  EXPECT_EQ(faultOf([&] { (void)readKalibrRun(other); }), InputFault::kUnknownFile);
}

}  // namespace
}  // namespace plumbline
