// SPDX-License-Identifier: BSD-3-Clause
// Kalibr's results in words: texts, poses, IMUs, and which of a folder's files belong together.
#include <cmath>
#include <functional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/base/lie.h"
#include "calibrator/base/time_offsets.h"
#include "datasets/calibration_reader.h"
#include "datasets/imu_reader.h"
#include "datasets/kalibr/poses.h"
#include "datasets/kalibr/run.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

const char* const kCamText = R"(Calibration results
====================
Camera-system parameters:
	cam0 (/left):
	 type: <class 'DoubleSphereCameraGeometry'>
	 distortion: [] +- []
	 projection: [  -0.25  0.5  300.  301.
   320. 240.] +- [0.01 0.02 0.1 0.2 0.3
 0.4]
	 reprojection error: [0.3, -0.4] +- [1.2, 0.0]

	cam1 (/right):
	 type: <class 'DistortedPinholeCameraGeometry'>
	 distortion: [-0.1  0.2  0.  0.] +- [0.01 0.01 0.01 0.01]
	 projection: [400. 401. 320. 240.] +- [1. 2. 3. 4.]
	 reprojection error: [0.0, 0.0] +- [0.3, 0.4]

	baseline T_1_0:
	 q: [0. 0. -0.70710678 0.70710678] +- [0.1 0.1 0.1]
	 t: [-0.1 0. 0.02] +- [0.1 0.1 0.1]



Target configuration
====================

  Type: aprilgrid
)";

const char* const kImuText = R"(Calibration results
===================
Normalized Residuals
----------------------------
Reprojection error (cam0):     mean 0.3, median 0.2, std: 0.4
Gyroscope error (imu0):        mean 3.0, median 2.0, std: 4.0
Accelerometer error (imu0):    mean 0.6, median 0.5, std: 0.8

Residuals
----------------------------
Reprojection error (cam0) [px]:     mean 0.3, median 0.2, std: 0.4
Gyroscope error (imu0) [rad/s]:     mean 0.003, median 0.002, std: 0.004
Accelerometer error (imu0) [m/s^2]: mean 0.06, median 0.05, std: 0.08

Transformation (cam0):
-----------------------
T_ci:  (imu0 to cam0): 
[[ 0.  1.  0.  0.05]
 [-1.  0.  0.  0.06]
 [ 0.  0.  1.  0.07]
 [ 0.  0.  0.  1.  ]]

T_ic:  (cam0 to imu0): 
[[ 0. -1.  0.  0.06]
 [ 1.  0.  0. -0.05]
 [ 0.  0.  1. -0.07]
 [ 0.  0.  0.  1.  ]]

timeshift cam0 to imu0: [s] (t_imu = t_cam + shift)
-0.0125


Gravity vector in target coords: [m/s^2]
[ 0.6 -9.7  0.8]


IMU configuration
=================

IMU0:
----------------------------
  Model: calibrated
  Update rate: 200.0
  Accelerometer:
    Noise density: 0.002
    Noise density (discrete): 0.0282842712475
    Random walk: 0.003
  Gyroscope:
    Noise density: 0.00017
    Noise density (discrete): 0.00240416305603
    Random walk: 2e-05
  T_i_b
    [[ 1.  0.  0.  0.]]
)";

const char* const kCamchainImu = R"(cam0:
  T_cam_imu:
  - [0.0, 1.0, 0.0, 0.05]
  - [-1.0, 0.0, 0.0, 0.06]
  - [0.0, 0.0, 1.0, 0.07]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  distortion_coeffs: [0.0, 0.0, 0.0, 0.0]
  distortion_model: radtan
  intrinsics: [400.0, 400.0, 320.0, 240.0]
  resolution: [640, 480]
  rostopic: /left
  timeshift_cam_imu: -0.0125
)";

const char* const kImu = R"(imu0:
  accelerometer_noise_density: 0.002
  accelerometer_random_walk: 0.003
  gyroscope_noise_density: 0.00017
  gyroscope_random_walk: 2.0e-05
  model: calibrated
  rostopic: /imu0
  update_rate: 200.0
)";

// What reading says of a fault.
std::string complaint(const std::function<void()>& read) {
  try {
    read();
    return "was accepted";
  } catch (const InputError& error) {
    return error.what();
  }
}

std::string complaintOfText(std::string text, const std::string& from, const std::string& to) {
  const TemporaryFolder folder;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  const std::string path = folder.write("results.txt", text);
  return complaint([&] { (void)readKalibrResults(path); });
}

TEST(KalibrResultsText, CameraToolsErrorsPerAxisGiveTheRms) {
  const TemporaryFolder folder;
  const KalibrResults text = readKalibrResults(folder.write("anything", kCamText));
  EXPECT_EQ(text.tool, KalibrResults::Tool::kCameras);
  ASSERT_EQ(text.cameras.size(), 2U);
  EXPECT_EQ(text.cameras[0].rostopic, "/left");
  ASSERT_EQ(text.cameras[0].projection.size(), 6);  // over two lines
  EXPECT_EQ(text.cameras[0].projection(5), 240);
  EXPECT_EQ(text.cameras[0].projection_std(5), 0.4);
  EXPECT_EQ(text.cameras[0].distortion.size(), 0);
  EXPECT_DOUBLE_EQ(*text.cameras[0].rmsPx(), 1.3);  // sqrt(.09 + .16 + 1.44 + 0)
  EXPECT_DOUBLE_EQ(*text.cameras[1].rmsPx(), 0.5);
  EXPECT_FALSE(text.noise);
}

TEST(KalibrResultsText, ABaselinesQuaternionIsScalarLastAndConjugate) {
  const TemporaryFolder folder;
  const KalibrResults text = readKalibrResults(folder.write("anything", kCamText));
  ASSERT_TRUE(text.cameras[1].T_cn_cnm1);
  const Transform expected(expSO3({0, 0, std::acos(0.0)}), {-0.1, 0, 0.02});
  EXPECT_LT(boxminus(*text.cameras[1].T_cn_cnm1, expected).norm(), 1e-7);
}

TEST(KalibrResultsText, ImuToolsErrorsTransformsAndNoise) {
  const TemporaryFolder folder;
  const KalibrResults text = readKalibrResults(folder.write("anything", kImuText));
  EXPECT_EQ(text.tool, KalibrResults::Tool::kCameraImu);
  ASSERT_EQ(text.cameras.size(), 1U);
  EXPECT_DOUBLE_EQ(*text.cameras[0].rmsPx(), 0.5);
  EXPECT_DOUBLE_EQ(text.gyro_normalised->rms(), 5);
  EXPECT_DOUBLE_EQ(text.gyro_rad_s->rms(), 0.005);
  EXPECT_DOUBLE_EQ(text.accel_normalised->rms(), 1);
  EXPECT_DOUBLE_EQ(text.accel_m_s2->rms(), 0.1);
  EXPECT_EQ(text.accel_m_s2->median, 0.05);
  EXPECT_EQ(text.cameras[0].T_cam_imu->t, Eigen::Vector3d(0.05, 0.06, 0.07));
  EXPECT_EQ(text.cameras[0].timeshift_cam_imu, -0.0125);
  EXPECT_EQ(*text.gravity_F, Eigen::Vector3d(0.6, -9.7, 0.8));
  EXPECT_EQ(text.noise->rate_hz, 200);
  EXPECT_EQ(text.noise->accel_density, 0.002);
  EXPECT_EQ(text.noise->accel_random_walk, 0.003);
  EXPECT_EQ(text.noise->gyro_density, 0.00017);
  EXPECT_EQ(text.noise->gyro_random_walk, 2e-5);
  EXPECT_EQ(text.imu_model, "calibrated");
}

TEST(KalibrResultsText, OldVersionsPrintSquares) {
  std::string text = kImuText;
  const std::size_t from = text.find("Normalized");
  text.replace(from, text.find("Transformation") - from,
               "Reprojection error squarred (cam0):  mean 0.25, median 0.1, std: 0.5\n"
               "Gyro error squarred (imu0):          mean 1.69, median 0.9, std: 2.0\n"
               "Accelerometer error squarred (imu0): mean 0.04, median 0.02, std: 0.1\n\n");
  const TemporaryFolder folder;
  const KalibrResults old = readKalibrResults(folder.write("anything", text));
  EXPECT_DOUBLE_EQ(old.cameras[0].normalised_error->rms(), 0.5);
  EXPECT_DOUBLE_EQ(old.gyro_normalised->rms(), 1.3);
  EXPECT_DOUBLE_EQ(old.accel_normalised->rms(), 0.2);
  EXPECT_FALSE(old.cameras[0].rmsPx());  // pixels are not printed
}

TEST(KalibrResultsText, DivergedResultsAreRefusedByLine) {
  EXPECT_THAT(complaintOfText(kCamText, "[0.3, -0.4]", "[nan, nan]"),
              AllOf(HasSubstr("results.txt:10:"), HasSubstr("diverged")));
  EXPECT_THAT(complaintOfText(kImuText, "mean 3.0", "mean nan"), HasSubstr("diverged"));
  EXPECT_THAT(complaintOfText(kImuText, "[ 0.  1.  0.  0.05]", "[ nan nan nan nan]"),
              HasSubstr("diverged"));
}

TEST(KalibrResultsText, TextsThatEndEarlyAreRefused) {
  const auto cut = [](const std::string& text, const std::string& at) {
    return complaintOfText(text, text.substr(text.find(at)), "");
  };
  EXPECT_THAT(cut(kCamText, "\t reprojection error: [0.0"), HasSubstr("cam1's reprojection error"));
  EXPECT_THAT(cut(kCamText, " 0.4]"), HasSubstr("ends before the end of a list"));
  EXPECT_THAT(cut(kCamText, "Target conf"), HasSubstr("ends before 'Target configuration'"));
  EXPECT_THAT(cut(kImuText, "T_ci"), HasSubstr("cam0's T_ci"));
  EXPECT_THAT(cut(kImuText, "Gravity"), HasSubstr("ends before the gravity"));
  EXPECT_THAT(cut(kImuText, "    Random walk: 2e-05"), HasSubstr("ends before the noise"));
  EXPECT_THAT(complaintOfText(kCamText, "Calibration results", "Results"), HasSubstr("no results"));
}

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
std::string posesText(bool as_the_header_says) {
  std::string text =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
      "q_RS_z []\n";
  for (int i = 0; i < 5; ++i) {
    const Transform T = lookingPose(i);
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
  EXPECT_THAT(complaint([&] { (void)readKalibrPoses(path); }), HasSubstr("as the header says"));
  EXPECT_EQ(kalibrFileKind(path), KalibrFileKind::kPoses);  // the header is Kalibr's
}

TEST(KalibrPoses, FaultsAreNamedByLine) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& text) {
    const std::string path = folder.write("poses.csv", text);
    return complaint([&] { (void)readKalibrPoses(path); });
  };
  const std::string good = "1,0,0,1,1,0,0,0\n";
  EXPECT_THAT(read(good + "2,0,0,1,1,0,0\n"), HasSubstr(":2: 7 columns"));
  EXPECT_THAT(read(good + "2,0,0,1,nan,0,0,0\n"), HasSubstr(":2: 'nan'"));
  EXPECT_THAT(read(good + "2,0,0,1,2,0,0,0\n"), HasSubstr("length is 2"));
  EXPECT_THAT(read(good + good), HasSubstr("ascend"));
  EXPECT_THAT(read("# nothing\n"), HasSubstr("no poses"));
}

// ---- IMUs

TEST(KalibrImus, ScaleAndMisalignmentAreReadForComparingOnly) {
  const std::string text =
      std::string(kImu).replace(std::string(kImu).find("calibrated"), 10, "scale-misalignment") +
      "  gyroscopes:\n    M:\n    - [1.01, 0.0, 0.0]\n    - [0.0, 1.0, 0.0]\n"
      "    - [0.0, 0.0, 0.99]\n";
  const TemporaryFolder folder;
  const std::string path = folder.write("imu.yaml", text);
  const KalibrImuFile file = readKalibrImus(path);
  EXPECT_TRUE(file.wrapped);
  EXPECT_EQ(file.imus[0].model, "scale-misalignment");
  EXPECT_EQ((*file.imus[0].gyro_M)(0, 0), 1.01);
  EXPECT_FALSE(file.imus[0].accel_M);
  EXPECT_THAT(complaint([&] { (void)readImuDescription(path); }), HasSubstr("not supported"));
}

// ---- folders

TEST(KalibrRuns, FilesAreKnownByContentNotByName) {
  const TemporaryFolder folder;
  using Kind = KalibrFileKind;
  EXPECT_EQ(kalibrFileKind(folder.write("1", kCamchainImu)), Kind::kCamchainImu);
  EXPECT_EQ(kalibrFileKind(folder.write("2", kImu)), Kind::kImu);
  EXPECT_EQ(kalibrFileKind(folder.write("3", kCamText)), Kind::kResultsCameras);
  EXPECT_EQ(kalibrFileKind(folder.write("4", kImuText)), Kind::kResultsImu);
  EXPECT_EQ(kalibrFileKind(folder.write("5", posesText(false))), Kind::kPoses);
  EXPECT_EQ(kalibrFileKind(folder.write("6", "target_type: aprilgrid\n")), std::nullopt);
  EXPECT_EQ(kalibrFileKind(folder.write("7", "%YAML:1.0\n---\nimu: 1\n")), std::nullopt);
  EXPECT_EQ(kalibrFileKind(folder.path("missing")), std::nullopt);
}

TEST(KalibrRuns, WhatBelongsTogetherIsGathered) {
  const TemporaryFolder folder;
  const std::string chain = folder.write("a", kCamchainImu);
  const std::string text = folder.write("b", kImuText);
  folder.write("c", kImu);
  // An IMU of another recording, and the text of another run.
  folder.write("d", std::string(kImu).replace(std::string(kImu).find("0.00017"), 7, "0.00099"));
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

TEST(KalibrRuns, SeveralRunsInAFolderMustBeNamed) {
  const TemporaryFolder folder;
  const std::string first = folder.write("run1.yaml", kCamchainImu);
  folder.write(
      "run2.yaml",
      std::string(kCamchainImu).replace(std::string(kCamchainImu).find("400.0"), 5, "401.0"));
  EXPECT_THAT(
      complaint([&] { (void)readKalibrRun(folder.path()); }),
      AllOf(HasSubstr("run1.yaml"), HasSubstr("run2.yaml"), HasSubstr("name the camchain")));
  EXPECT_EQ(readKalibrRun(first).calibration().cameras[0].intrinsics.projection(0), 400);
}

TEST(KalibrRuns, FoldersWithoutACamchainAreRefused) {
  const TemporaryFolder folder;
  folder.write("imu.yaml", kImu);
  EXPECT_THAT(complaint([&] { (void)readKalibrRun(folder.path()); }), HasSubstr("no camchain"));
  const std::string other = folder.write("target.yaml", "target_type: aprilgrid\n");
  EXPECT_THAT(complaint([&] { (void)readKalibrRun(other); }), HasSubstr("no output of Kalibr"));
}

// ---- time shifts

std::string withSecondCamera(const std::string& shift) {
  std::string second = kCamchainImu;
  second.replace(second.find("cam0"), 4, "cam1");
  second.replace(second.find("-0.0125"), 7, shift);
  return kCamchainImu + second;
}

TEST(KalibrTimeShifts, EachIsKeptAndTheMeanIsThere) {
  const TemporaryFolder folder;
  const auto imu = *readCalibration(folder.write("chain", withSecondCamera("-0.0135"))).imu;
  EXPECT_EQ(imu.time_offset_s, -0.0125);  // camera 0's
  EXPECT_EQ(imu.camera_time_offsets_s, (std::vector<double>{-0.0125, -0.0135}));
  EXPECT_DOUBLE_EQ(meanTimeOffset(imu), -0.013);
  EXPECT_EQ(cameraTimeOffset(imu, 1), -0.0135);
}

TEST(KalibrTimeShifts, EqualOnesAreOneOffset) {
  const TemporaryFolder folder;
  const auto imu = *readCalibration(folder.write("chain", withSecondCamera("-0.0125"))).imu;
  EXPECT_TRUE(imu.camera_time_offsets_s.empty());
  EXPECT_EQ(meanTimeOffset(imu), -0.0125);
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
  const Calibration c = readCalibration(folder.write("result.yaml", text));
  ASSERT_EQ(c.cameras.size(), 2U);
  EXPECT_EQ(c.cameras[1].intrinsics.distortion_model, DistortionModel::kEquidistant);
  EXPECT_EQ(c.cameras[1].T_C0Ci.t, Eigen::Vector3d(0.11, 0, 0));  // camera 1 to the right
  EXPECT_EQ(c.imu->T_SC0.t, Eigen::Vector3d(-0.02, -0.06, 0.01));
  EXPECT_EQ(c.imu->T_SC0.R(0, 1), -1);
  EXPECT_EQ(c.imu->time_offset_s, 0.0015);
  EXPECT_EQ(c.imu->noise.gyro_density, 1.7e-4);
  EXPECT_EQ(c.imu->noise.accel_random_walk, 3e-3);
  EXPECT_EQ(c.imu->gravity_m_s2, 9.81);
}

}  // namespace
}  // namespace plumbline
