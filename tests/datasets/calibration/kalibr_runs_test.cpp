// SPDX-License-Identifier: BSD-3-Clause
// Kalibr's poses, IMUs and time shifts, which of a folder's files belong together, and yac's
// results.
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/calibration.h"
#include "calibrator/base/transform.h"
#include "datasets/calibration/calibration_reader.h"
#include "datasets/calibration/kalibr/run.h"
#include "datasets/session/imu.h"
#include "tests/datasets/calibration/kalibr_texts.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

// ---- poses

// A camera on a curve in front of the target that looks at its middle, rolled a little.
Transform lookingPose(int i) {
  const Eigen::Vector3d p(0.3 + 0.4 * std::sin(i), 0.3 + 0.3 * std::cos(1.7 * i), 0.8);
  const Eigen::Vector3d z = (Eigen::Vector3d(0.3, 0.3, 0) - p).normalized();
  const Eigen::Vector3d x = Eigen::Vector3d(1, 0.02 * i, 0).cross(z).cross(z).normalized() * -1;
  Eigen::Matrix3d R;
  R << x, z.cross(x), z;
  return {R, p};
}

// As Kalibr writes it: x, y, z, w of the conjugate.
std::string posesText(bool as_the_header_says, const Transform& turn = {}) {
  std::string text =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
      "q_RS_z []\n";
  for (int i = 0; i < 5; ++i) {
    const Transform T = lookingPose(i) * turn;
    const Eigen::Quaterniond q = T.quaternion();
    const Eigen::Vector4d v = as_the_header_says ? Eigen::Vector4d(q.w(), q.x(), q.y(), q.z())
                                                 : Eigen::Vector4d(-q.x(), -q.y(), -q.z(), q.w());
    text += std::to_string(1404733405832800000 + i * 50'000'000LL);
    for (const double p : T.t) text += "," + std::to_string(p);
    for (const double c : v) text += "," + std::to_string(c);
    text += "\n";
  }
  return text;
}

TEST(KalibrPoses, TheHeaderIsWrongAboutItsQuaternions) {
  const TemporaryFolder folder;
  const Trajectory poses = readKalibrPoses(folder.write("poses.csv", posesText(false)));
  ASSERT_EQ(poses.poses.size(), 5U);
  EXPECT_EQ(poses.poses[1].t, 1404733405882800000);
  for (int i = 0; i < 5; ++i) {
    EXPECT_LT(boxminus(poses.poses[i].transform(), lookingPose(i)).norm(), 1e-5);
  }
}

TEST(KalibrPoses, AFileThatKeepsItsHeadersPromiseIsNotKalibrs) {
  const TemporaryFolder folder;
  const std::string path = folder.write("poses.csv", posesText(true));
  EXPECT_EQ(faultOf([&] { (void)readKalibrPoses(path); }), InputFault::kContradiction);
  EXPECT_EQ(kalibrFileKind(path), KalibrFileKind::kPoses);  // the header is Kalibr's
}

// The same cameras turned about their own x: the target is behind them, so that they saw nothing.
TEST(KalibrPoses, CamerasThatLookAwayFromTheTargetAreNotKalibrs) {
  const Transform back(expSO3({2 * std::acos(0.0), 0, 0}), Eigen::Vector3d::Zero());
  const TemporaryFolder folder;
  const std::string path = folder.write("poses.csv", posesText(false, back));
  EXPECT_EQ(faultOf([&] { (void)readKalibrPoses(path); }), InputFault::kContradiction);
}

TEST(KalibrPoses, FaultsAreNamedByLine) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& text) {
    const std::string path = folder.write("poses.csv", text);
    return faultOf([&] { (void)readKalibrPoses(path); });
  };
  const std::string good = "1,0,0,1,1,0,0,0\n";
  EXPECT_EQ(read(good + "2,0,0,1,1,0,0\n"), InputFault::kBadColumns);
  EXPECT_EQ(read(good + "2,0,0,1,nan,0,0,0\n"), InputFault::kNotFinite);
  EXPECT_EQ(read(good + "2,0,0,1,2,0,0,0\n"), InputFault::kNotRigid);
  EXPECT_EQ(read(good + good), InputFault::kBadOrder);
  EXPECT_EQ(read("# nothing\n"), InputFault::kEmpty);
}

// ---- IMUs

TEST(KalibrImus, ScaleAndMisalignmentAreReadForComparingOnly) {
  const std::string text = std::string(kImuYaml).replace(std::string(kImuYaml).find("calibrated"),
                                                         10, "scale-misalignment") +
                           "  gyroscopes:\n    M:\n    - [1.01, 0.0, 0.0]\n    - [0.0, 1.0, 0.0]\n"
                           "    - [0.0, 0.0, 0.99]\n";
  const TemporaryFolder folder;
  const std::string path = folder.write("imu.yaml", text);
  const KalibrImuFile file = readKalibrImus(path);
  EXPECT_TRUE(file.wrapped);
  EXPECT_EQ(file.imus[0].model, "scale-misalignment");
  EXPECT_EQ((*file.imus[0].gyro_M)(0, 0), 1.01);
  EXPECT_TRUE(file.imus[0].isDistorted());
  EXPECT_FALSE(readKalibrImus(folder.write("plain.yaml", kImuYaml)).imus[0].isDistorted());
  EXPECT_FALSE(file.imus[0].accel_M);
  EXPECT_EQ(faultOf([&] { (void)readImuDescription(path); }), InputFault::kUnsupported);
}

TEST(KalibrImus, EveryMatrixCountsWhateverTheModelIsCalled) {
  const TemporaryFolder folder;
  const auto fault = [&](const std::string& more) {
    const std::string path = folder.write("imu.yaml", kImuYaml + more);
    return faultOf([&] { (void)readImuDescription(path); });
  };
  const std::string first = "    - [1.0, 0.0, 0.0]\n", third = "    - [0.0, 0.0, 1.0]\n";
  EXPECT_EQ(fault("  gyroscopes:\n    M:\n" + first + "    - [0.0, 1.0, 0.0]\n" + third),
            std::nullopt);
  // A, the rates' dependence on acceleration [rad/s per m/s^2], is zero in an IMU without faults.
  const std::string zeros = "    - [0.0, 0.0, 0.0]\n", sensitivity = "  gyroscopes:\n    A:\n";
  EXPECT_EQ(fault(sensitivity + zeros + zeros + zeros), std::nullopt);
  EXPECT_EQ(fault(sensitivity + first + "    - [0.0, 1.0, 0.0]\n" + third),
            InputFault::kUnsupported);
  for (const char* matrix : {"A", "C_gyro_i", "M"}) {
    const std::string key = std::string("  gyroscopes:\n    ") + matrix + ":\n";
    EXPECT_EQ(fault(key + first + "    - [0.0, 0.9, 0.1]\n" + third), InputFault::kUnsupported);
    EXPECT_EQ(fault(key + "    - [1.0, 0.0]\n    - [0.0, 1.0]\n"), InputFault::kBadNumber);
  }
}

// OpenVINS' own files say "kalibr" and the identity; what they estimated would be lost.
TEST(KalibrImus, MatricesOfOpenVinsCountToo) {
  const TemporaryFolder folder;
  const std::string first = "    - [1.0, 0.0, 0.0]\n", third = "    - [0.0, 0.0, 1.0]\n";
  for (const char* model : {"calibrated", "kalibr", "rpng"}) {
    std::string text = "%YAML:1.0\n\n" + std::string(kImuYaml);
    text.replace(text.find("calibrated"), 10, model);
    const auto fault = [&](const char* key, const char* second) {
      const std::string rows = std::string("  ") + key + ":\n" + first + second + third;
      const std::string path = folder.write("imu.yaml", text + rows);
      return faultOf([&] { (void)readImuDescription(path); });
    };
    for (const char* key : {"Tw", "R_IMUtoGYRO", "Ta", "R_IMUtoACC"}) {
      EXPECT_EQ(fault(key, "    - [0.0, 1.0, 0.0]\n"), std::nullopt) << model << key;
      EXPECT_EQ(fault(key, "    - [0.0, 0.99, 0.0]\n"), InputFault::kUnsupported) << model << key;
    }
    EXPECT_EQ(fault("Tg", "    - [0.0, 0.0, 0.0]\n"), InputFault::kUnsupported) << model;
  }
}

// The samples are in the IMU's own frame, as results are.
TEST(KalibrImus, TheBodyOfEurocDoesNotMatter) {
  const TemporaryFolder folder;
  const std::string path = folder.write(
      "imu.yaml", std::string(kImuYaml) +
                      "  T_BS:\n    rows: 4\n    cols: 4\n"
                      "    data: [0, -1, 0, 0.1, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n");
  EXPECT_EQ(readImuDescription(path).noise.gyro_density, 0.00017);
}

TEST(KalibrImus, NoneIsLeftOut) {
  std::string third = kImuYaml;
  const std::string text = kImuYaml + third.replace(third.find("imu0"), 4, "imu2");
  const TemporaryFolder folder;
  const std::string path = folder.write("imu.yaml", text);
  EXPECT_EQ(faultOf([&] { (void)readKalibrImus(path); }), InputFault::kMissingKey);
}

// ---- folders

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
  EXPECT_EQ(kalibrFileKind(folder.write("5", posesText(false))), Kind::kPoses);
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
  folder.write("poses.csv", posesText(true));
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

// ---- time shifts

std::string withSecondCamera(const std::string& shift) {
  std::string second = kCamchainImuYaml;
  second.replace(second.find("cam0"), 4, "cam1");
  second.replace(second.find("-0.0125"), 7, shift);
  return kCamchainImuYaml + second;
}

TEST(KalibrTimeShifts, EachIsKeptAndTheMeanIsThere) {
  const TemporaryFolder folder;
  const auto imu = *readCalibration(folder.write("chain", withSecondCamera("-0.0135"))).imu;
  EXPECT_EQ(imu.timeOffset(), -0.0125);  // camera 0's
  EXPECT_DOUBLE_EQ(meanTimeOffset(imu), -0.013);
  EXPECT_TRUE(hasOwnOffset(imu.time_offsets, 1));
  EXPECT_EQ(imu.timeOffset(1), -0.0135);
}

TEST(KalibrTimeShifts, EqualOnesAreOneOffset) {
  const TemporaryFolder folder;
  const auto imu = *readCalibration(folder.write("chain", withSecondCamera("-0.0125"))).imu;
  EXPECT_FALSE(haveOwnOffsets(imu.time_offsets));
  EXPECT_EQ(meanTimeOffset(imu), -0.0125);
}

// A camera that was not calibrated for time has the shift of the first one that was, not none.
TEST(KalibrTimeShifts, ACameraWithoutOneTakesThatOfAnother) {
  const TemporaryFolder folder;
  const auto without = [](const char* camera) {
    std::string text = withSecondCamera("-0.0135");
    const std::size_t at = text.find("  timeshift", text.find(camera));
    return text.erase(at, text.find('\n', at) + 1 - at);
  };
  const std::string second = folder.write("second.yaml", without("cam1"));
  const std::string first = folder.write("first.yaml", without("cam0"));
  const auto imu = *readCalibration(second).imu;
  EXPECT_EQ(imu.timeOffset(1), -0.0125);
  EXPECT_FALSE(hasOwnOffset(imu.time_offsets, 1));
  EXPECT_EQ(readCalibration(first).imu->timeOffset(), -0.0135);
  EXPECT_TRUE(statesTimeOffset(first) && statesTimeOffset(second));
  std::string neither = kCamchainImuYaml;
  neither.erase(neither.find("  timeshift"));
  EXPECT_FALSE(statesTimeOffset(folder.write("neither.yaml", neither)));
}

// ---- yac

TEST(YacResults, AreCalibrations) {
  const TemporaryFolder folder;
  const std::string text = R"(imu0:
  rate: 200.0
  sigma_a_c: 2.0e-03
  sigma_g_c: 1.7e-04
  sigma_aw_c: 3.0e-03
  sigma_gw_c: 2.0e-05
  g: 9.81
  ba: [-0.002198, 0.024434, 0.076713]
time_delay: 0.0015  # imu_timestamp = camera_timestamp + time_delay
cam0:
  resolution: [752, 480]
  proj_model: "pinhole"
  dist_model: "radtan4"
  proj_params: [458.0, 457.0, 367.0, 248.0]
  dist_params: [-0.28, 0.07, 0.0002, 1.0e-05]
cam1:
  resolution: [752, 480]
  proj_model: "pinhole"
  dist_model: "equi4"
  proj_params: [458.0, 457.0, 367.0, 248.0]
  dist_params: [-0.28, 0.07, 0.0002, 1.0e-05]
T_cam0_cam1:
  rows: 4
  cols: 4
  data: [1, 0, 0, 0.11,  0, 1, 0, 0,  0, 0, 1, 0,  0, 0, 0, 1]
T_imu0_cam0:
  rows: 4
  cols: 4
  data: [0, -1, 0, -0.02,  1, 0, 0, -0.06,  0, 0, 1, 0.01,  0, 0, 0, 1]
)";
  std::string gap = text;
  gap.replace(gap.find("cam1:"), 5, "cam2:");
  EXPECT_EQ(faultOf([&] { (void)readCalibration(folder.write("gap.yaml", gap)); }),
            InputFault::kMissingKey);
  const Calibration c = readCalibration(folder.write("result.yaml", text));
  ASSERT_EQ(c.cameras.size(), 2U);
  EXPECT_EQ(c.cameras[1].intrinsics.distortion_model, DistortionModel::kEquidistant);
  EXPECT_EQ(c.cameras[1].T_C0Ci.t, Eigen::Vector3d(0.11, 0, 0));  // camera 1 to the right
  EXPECT_EQ(c.imu->T_SC0.t, Eigen::Vector3d(-0.02, -0.06, 0.01));
  EXPECT_EQ(c.imu->T_SC0.R(0, 1), -1);
  EXPECT_EQ(c.imu->timeOffset(), 0.0015);
  EXPECT_EQ(c.imu->noise.gyro_density, 1.7e-4);
  EXPECT_EQ(c.imu->noise.gyro_random_walk, 2e-5);
  EXPECT_EQ(c.imu->noise.accel_density, 2e-3);
  EXPECT_EQ(c.imu->noise.accel_random_walk, 3e-3);
  EXPECT_EQ(c.imu->noise.rate_hz, 200);
  EXPECT_EQ(c.imu->gravity_m_s2, 9.81);
  for (const char* g : {"1.62", "32.2"}) {  // of the moon, or in feet
    std::string other = text;
    other.replace(other.find("9.81"), 4, g);
    const auto refusal =
        refusalOf([&] { (void)readCalibration(folder.write("other.yaml", other)); });
    ASSERT_TRUE(refusal) << g;
    EXPECT_EQ(refusal->line(), 7);
  }
}

}  // namespace
}  // namespace plumbline
