// SPDX-License-Identifier: BSD-3-Clause
// Kalibr's files, written and read back.
#include <functional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "datasets/calibration/calibration_reader.h"
#include "datasets/calibration/kalibr_writer.h"
#include "datasets/files/numbers.h"
#include "datasets/session/imu.h"
#include "datasets/session/target.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

Calibration threeCameraRig() {
  Calibration rig;
  for (int i = 0; i < 3; ++i) {
    CameraCalibration camera;
    camera.name = "cam" + std::to_string(i);
    camera.intrinsics.resolution = {752, 480};
    camera.intrinsics.projection = Eigen::Vector4d(458.654 + i, 457.296, 367.215, 248.375);
    camera.intrinsics.distortion = Eigen::Vector4d(-0.283, 0.074, 1e-5, 1.0 / 3);
    if (i == 1) camera.intrinsics.distortion_model = DistortionModel::kEquidistant;
    camera.T_C0Ci = Transform(expSO3({0.01 * i, -0.02 * i, 0.03 * i}),
                              Eigen::Vector3d(0.11 * i, -0.002 * i, 0.003 * i));
    rig.cameras.push_back(camera);
  }
  rig.imu.emplace();
  rig.imu->T_SC0 = Transform(expSO3({0.1, 0.2, 1.5}), Eigen::Vector3d(-0.02, -0.06, 0.01));
  rig.imu->time_offsets = {{-1e-5}};
  return rig;
}

TEST(KalibrFiles, CamchainComesBack) {
  const TemporaryFolder folder;
  const Calibration rig = threeCameraRig();
  const Calibration again =
      readCalibration(folder.write("camchain-imucam.yaml", kalibrCamchainText(rig)));
  ASSERT_EQ(again.cameras.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const CameraCalibration& a = again.cameras[i];
    const CameraCalibration& b = rig.cameras[i];
    EXPECT_EQ(a.intrinsics.stacked(), b.intrinsics.stacked());  // to the last bit
    EXPECT_EQ(a.intrinsics.distortion_model, b.intrinsics.distortion_model);
    EXPECT_EQ(a.intrinsics.resolution, b.intrinsics.resolution);
    EXPECT_LT(boxminus(a.T_C0Ci, b.T_C0Ci).norm(), 1e-14);  // products of three transforms
  }
  ASSERT_TRUE(again.imu);
  EXPECT_EQ(again.imu->timeOffset(), -1e-5);
  EXPECT_LT(boxminus(again.imu->T_SC0, rig.imu->T_SC0).norm(), 1e-14);
}

// Kalibr's key and OpenVINS' in one camera: whoever edits one may forget the other.
TEST(KalibrFiles, BothPlacesOfTheImuMustBeOne) {
  const TemporaryFolder folder;
  const Calibration rig = threeCameraRig();
  const auto with = [&](const Transform& T_imu_cam) {
    std::string text = kalibrCamchainText(rig);
    text.insert(text.find("  T_cam_imu"), "  T_imu_cam:\n" + yamlRows(T_imu_cam.matrix(), "  "));
    return folder.write("camchain-imucam.yaml", text);
  };
  const Calibration again = readCalibration(with(rig.imu->T_SC0));
  EXPECT_LT(boxminus(again.imu->T_SC0, rig.imu->T_SC0).norm(), 1e-14);
  const auto refusal = refusalOf([&] { readCalibration(with(rig.imu->T_SC0.inverse())); });
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->code(), InputFault::kContradiction);
  EXPECT_EQ(refusal->line(), 3);
}

TEST(KalibrFiles, TheImuIsWhereAnotherCameraThanTheFirstSaysIt) {
  const TemporaryFolder folder;
  const Calibration rig = threeCameraRig();
  std::string text = kalibrCamchainText(rig);
  for (const char* next : {"  cam_overlaps", "  T_cn_cnm1"}) {
    const std::size_t at = text.find("  T_cam_imu:");
    text.erase(at, text.find(next, at) - at);
    const Calibration again = readCalibration(folder.write("camchain-imucam.yaml", text));
    ASSERT_TRUE(again.imu);
    EXPECT_EQ(again.imu->timeOffset(), -1e-5);
    EXPECT_LT(boxminus(again.imu->T_SC0, rig.imu->T_SC0).norm(), 1e-14);
  }
}

// Kalibr's cam_overlaps name cameras of the file: one that is cut off is still named.
TEST(KalibrFiles, AFileThatWasCutBetweenItsCamerasIsRefused) {
  const TemporaryFolder folder;
  const std::string text = kalibrCamchainText(threeCameraRig());
  const std::string cut = folder.write("cut.yaml", text.substr(0, text.find("cam2:")));
  const auto refused = refusalOf([&] { (void)readCalibration(cut); });
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->code(), InputFault::kMissingKey);
  EXPECT_GT(refused->line(), 1);
  EXPECT_THAT(refused->what(), HasSubstr("cam2 is listed, which the file does not have"));
  EXPECT_THAT(refused->what(), HasSubstr("take it out of cam_overlaps as well"));
}

// By the IMU, of which two cameras say where it is; one alone does not place itself in the rig.
TEST(KalibrFiles, ACameraIsPlacedByItsImuAndThatOfACameraBefore) {
  const TemporaryFolder folder;
  const Calibration rig = threeCameraRig();
  std::string text = kalibrCamchainText(rig);
  const auto erase = [&](std::size_t at) { text.erase(at, text.find("  cam_overlaps", at) - at); };
  erase(text.rfind("  T_cn_cnm1:"));
  const std::size_t first = text.find("  T_cam_imu:");
  erase(first);
  const Calibration again = readCalibration(folder.write("camchain-imucam.yaml", text));
  EXPECT_LT(boxminus(again.cameras[2].T_C0Ci, rig.cameras[2].T_C0Ci).norm(), 1e-14);
  EXPECT_LT(boxminus(again.imu->T_SC0, rig.imu->T_SC0).norm(), 1e-14);
  const std::size_t second = text.find("  T_cam_imu:");
  text.erase(second, text.find("  T_cn_cnm1:", second) - second);
  const auto refused =
      refusalOf([&] { (void)readCalibration(folder.write("camchain-imucam.yaml", text)); });
  ASSERT_TRUE(refused);
  EXPECT_THAT(refused->what(),
              HasSubstr("T_cam_imu is given without T_cn_cnm1, and no camera before has one"));
}

TEST(KalibrFiles, TransformsHaveKalibrsDirections) {
  // A camera 10 cm to the right of camera 0, the IMU 5 cm behind camera 0, no rotations.
  Calibration rig = threeCameraRig();
  rig.cameras.resize(2);
  rig.cameras[1].T_C0Ci = Transform(Eigen::Matrix3d::Identity(), {0.1, 0, 0});
  rig.imu->T_SC0 = Transform(Eigen::Matrix3d::Identity(), {0, 0, 0.05});
  const std::string text = kalibrCamchainText(rig);
  // Camera 0's origin lies at x = -0.1 in camera 1; the IMU at z = -0.05 in both.
  EXPECT_THAT(text, HasSubstr("T_cn_cnm1:\n  - [1.0, 0.0, 0.0, -0.1]"));
  EXPECT_THAT(text, HasSubstr("  - [0.0, 0.0, 1.0, -0.05]"));
}

TEST(KalibrFiles, NumbersHaveADecimalPointBeforeTheExponent) {
  // YAML 1.1, which Kalibr's reader follows, takes 1e-05 for a word.
  const std::string text = kalibrCamchainText(threeCameraRig());
  EXPECT_THAT(text, HasSubstr("timeshift_cam_imu: -1.0e-05"));
  EXPECT_THAT(text, Not(HasSubstr(" 1e-05")));
}

TEST(KalibrFiles, EachCameraHasItsOwnTimeShift) {
  Calibration rig = threeCameraRig();
  rig.imu->time_offsets = {{0.25}, {0.5, true}, {0.75, true}};
  const std::string text = kalibrCamchainText(rig);
  for (const char* shift : {"0.25", "0.5", "0.75"}) {
    EXPECT_THAT(text, HasSubstr(std::string("timeshift_cam_imu: ") + shift + "\n"));
  }
}

TEST(KalibrFiles, ImuAndTargetComeBack) {
  const TemporaryFolder folder;
  const ImuNoise noise{1.1e-4, 2.2e-5, 3.3e-3, 4.4e-3, 400};
  const ImuDescription imu =
      readImuDescription(folder.write("imu.yaml", kalibrImuText(noise, "/imu7")));
  EXPECT_EQ(imu.noise.gyro_density, 1.1e-4);
  EXPECT_EQ(imu.noise.gyro_random_walk, 2.2e-5);
  EXPECT_EQ(imu.noise.accel_density, 3.3e-3);
  EXPECT_EQ(imu.noise.accel_random_walk, 4.4e-3);
  EXPECT_EQ(imu.noise.rate_hz, 400);
  EXPECT_EQ(imu.rostopic, "/imu7");
  AprilGrid grid;
  grid.rows = 7;
  grid.cols = 5;
  grid.tag_size = 0.046;
  grid.spacing = 0.25;
  const AprilGrid again = readTarget(folder.write("target.yaml", kalibrTargetText(grid)));
  EXPECT_EQ(again.rows, 7);
  EXPECT_EQ(again.cols, 5);
  EXPECT_EQ(again.tag_size, 0.046);
  EXPECT_EQ(again.spacing, 0.25);
}

TEST(KalibrFiles, TopicsOfAnyTextComeBackAndAddNoKeys) {
  const TemporaryFolder folder;
  for (const char* topic : {"/imu0", "my topic", "a: b # c", "x\ngyroscope_noise_density: 9",
                            "\"'\\", "1.5", "-", "*a", "null", "Yes", "off", "n"}) {
    const ImuDescription imu =
        readImuDescription(folder.write("imu.yaml", kalibrImuText(ImuNoise(), topic)));
    EXPECT_EQ(imu.rostopic, topic);
    EXPECT_EQ(imu.noise.gyro_density, ImuNoise().gyro_density);
  }
  // Other readers of YAML make more of them than ours.
  for (const char* word : {"null", "yes", "No", "TRUE"}) {
    EXPECT_THAT(kalibrImuText(ImuNoise(), word), HasSubstr("\"" + std::string(word) + "\""));
  }
}

TEST(KalibrFiles, SampleConfigurationsAreReadable) {
  const std::string folder = std::string(PLUMBLINE_SOURCE_DIR) + "/third_party_configs/";
  EXPECT_EQ(readTarget(folder + "targets/target_6x6.yaml").tag_size, 0.088);
  EXPECT_EQ(readImuDescription(folder + "imu/imu_adis16448.yaml").noise.gyro_density, 1.6968e-4);
  EXPECT_EQ(readImuDescription(folder + "imu/imu_d435i.yaml").noise.accel_density, 2.52e-2);
}

// What the text with its first `from` replaced is refused for as a camchain.
std::optional<InputFault> complaint(std::string text, const std::string& from,
                                    const std::string& to) {
  const TemporaryFolder folder;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  return faultOf([&] { (void)readCalibration(folder.write("camchain.yaml", text)); });
}

TEST(KalibrFiles, FaultsOfACamchainAreNamed) {
  const std::string good = kalibrCamchainText(threeCameraRig());
  EXPECT_EQ(complaint(good, "timeshift_cam_imu:", "line_delay:"), InputFault::kUnsupported);
  EXPECT_EQ(complaint(good, "resolution: [752, 480]", "resolution: [752]"), InputFault::kBadNumber);
  EXPECT_EQ(complaint(good, "camera_model: pinhole", "camera_model: fisheye"),
            InputFault::kUnknownWord);
  EXPECT_EQ(complaint(good, "camera_model: pinhole", "camera_model: omni"), InputFault::kBadNumber);
  EXPECT_EQ(complaint(good, "[0.0, 0.0, 0.0, 1.0]", "[0.0, 0.0, 0.0, 2.0]"), InputFault::kNotRigid);
  EXPECT_EQ(complaint(good, "cam0:", "camA:"), InputFault::kUnknownFile);
  const TemporaryFolder folder;
  std::string renamed = good;
  renamed.replace(renamed.find("cam0:"), 5, "left:");
  const auto refused =
      refusalOf([&] { (void)readCalibration(folder.write("camchain.yaml", renamed)); });
  ASSERT_TRUE(refused);
  EXPECT_THAT(refused->what(), HasSubstr("a camera's key is 'left', and there is no 'cam0'"));
  EXPECT_EQ(complaint(good, "cam1:", "camB:"), InputFault::kMissingKey) << "cam2 without cam1";
  for (const char* no_boolean : {"1", "rolling"}) {
    EXPECT_EQ(complaint(good, "timeshift_cam_imu:",
                        std::string("rolling_shutter: ") + no_boolean + "\n  timeshift_cam_imu:"),
              InputFault::kBadNumber);
  }
}

TEST(KalibrFiles, AnInvertedTransformContradictsTheChain) {
  const Calibration rig = threeCameraRig();
  Calibration inverted = rig;
  inverted.cameras[1].T_C0Ci = rig.cameras[1].T_C0Ci.inverse();
  const std::string good = kalibrCamchainText(rig);
  const std::string bad = kalibrCamchainText(inverted);
  const auto chainOf = [](const std::string& text) {
    const std::size_t at = text.find("  T_cn_cnm1:");
    return text.substr(at, text.find("  cam_overlaps", at) - at);
  };
  EXPECT_EQ(complaint(good, chainOf(good), chainOf(bad)), InputFault::kContradiction);
}

// Each link is within 1000 m, and the camera at the end of two is not.
TEST(KalibrFiles, ACameraThatIsFarOnlyByTheWholeChainIsRefused) {
  const TemporaryFolder folder;
  Calibration rig = threeCameraRig();
  rig.imu.reset();
  for (int i = 0; i < 3; ++i) rig.cameras[i].T_C0Ci.t = {400.0 * i, 0, 0};
  EXPECT_NO_THROW((void)readCalibration(folder.write("near.yaml", kalibrCamchainText(rig))));
  rig.cameras[2].T_C0Ci.t.x() = 1200;
  const std::string far = kalibrCamchainText(rig);
  EXPECT_EQ(faultOf([&] { (void)readCalibration(folder.write("far.yaml", far)); }),
            InputFault::kOutOfRange);
}

}  // namespace
}  // namespace plumbline
