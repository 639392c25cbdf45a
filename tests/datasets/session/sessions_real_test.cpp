// SPDX-License-Identifier: BSD-3-Clause
// Real recordings, as they lie in PLUMBLINE_SHARED_DATA.
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "datasets/calibration/calibration_reader.h"
#include "datasets/session/session_reader.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

std::string sharedData(const std::string& name) {
  const fs::path path = fs::path(PLUMBLINE_SHARED_DATA) / name;
  EXPECT_TRUE(fs::exists(path)) << path << " is missing; configure with -DPLUMBLINE_SHARED_DATA="
                                << "<folder of the real recordings>";
  return path.string();
}

std::size_t cornersOf(const CameraStream& camera) {
  std::size_t count = 0;
  for (const ImageView& view : camera.views) count += view.corners.size();
  return count;
}

TEST(RealSessions, EurocRecordingHasItsKnownCounts) {
  const Session session = readSession(sharedData("euroc_imu_april"));
  ASSERT_EQ(session.cameras.size(), 2U);
  EXPECT_EQ(session.name, "euroc_imu_april");
  EXPECT_EQ(session.cameras[0].views.size(), 1416U);
  EXPECT_EQ(session.cameras[1].views.size(), 1416U);
  EXPECT_EQ(cornersOf(session.cameras[0]), 179524U);
  EXPECT_EQ(cornersOf(session.cameras[1]), 178764U);
  ASSERT_TRUE(session.imu.has_value());
  EXPECT_EQ(session.imu->samples.size(), 14374U);
  EXPECT_EQ(session.imu->rostopic, "/imu0");
  EXPECT_DOUBLE_EQ(session.imu->noise.gyro_density, 0.00016968);
  EXPECT_DOUBLE_EQ(session.target.tag_size, 0.088);
  EXPECT_EQ(session.cameras[0].resolution, (Resolution{752, 480}));
}

TEST(RealSessions, EurocFirstRowsAreReadExactly) {
  const Session session = readSession(sharedData("euroc_imu_april"));
  const ImageView& view = session.cameras[0].views.front();
  EXPECT_EQ(view.t, 1404733405732800000);
  EXPECT_EQ(view.corners[0].id, 0);
  EXPECT_EQ(view.corners[0].uv.x(), 175.986694);
  EXPECT_EQ(view.corners[1].uv.y(), 334.509460);
  const ImuSample& sample = session.imu->samples.front();
  EXPECT_EQ(sample.t, 1404733405747800064);
  EXPECT_EQ(sample.gyro, Eigen::Vector3d(0.014661, -0.028623, 0.125664));
  EXPECT_EQ(sample.accel, Eigen::Vector3d(9.365351, -0.335061, -3.277056));
}

TEST(RealSessions, EurocImagesAreListedWithTheirStamps) {
  const Recording recording = readRecording(sharedData("euroc_cam_april_images"));
  ASSERT_EQ(recording.session.cameras.size(), 2U);
  EXPECT_TRUE(recording.needsDetection());
  EXPECT_FALSE(recording.session.imu.has_value());
  for (std::size_t c = 0; c < 2; ++c) {
    const CameraStream& camera = recording.session.cameras[c];
    ASSERT_EQ(recording.images[c].size(), 26U);
    ASSERT_EQ(camera.views.size(), 26U);
    EXPECT_EQ(camera.camera_model, "pinhole");
    EXPECT_EQ(camera.distortion_model, "radtan");  // EuRoC writes radial-tangential
    for (std::size_t i = 0; i < 26; ++i) {
      EXPECT_EQ(recording.images[c][i].t, 1'000'000'000 + static_cast<TimeNs>(i) * 100'000'000);
      EXPECT_EQ(camera.views[i].t, recording.images[c][i].t);
    }
  }
}

// Published with the dataset: camera 1 lies 11 cm to the right of camera 0.
TEST(RealCalibrations, EurocCamchainHasItsKnownGeometry) {
  const Calibration rig =
      readCalibration(sharedData("euroc_imu_april/kalibr/camchain-imucam.yaml"));
  ASSERT_EQ(rig.cameras.size(), 2U);
  EXPECT_NEAR(rig.cameras[1].T_C0Ci.t.x(), 0.1101, 1e-4);
  ASSERT_TRUE(rig.imu);
  EXPECT_NEAR(rig.imu->T_SC0.t.x(), -0.0216, 1e-4);  // EuRoC's own T_BS of cam0
  EXPECT_NEAR(rig.imu->T_SC0.t.y(), -0.0647, 1e-4);
  EXPECT_NEAR(rig.imu->T_SC0.t.z(), 0.0098, 1e-4);
}

TEST(RealCalibrations, EveryCamchainInTheWildIsReadOrRefusedForItsReason) {
  int read = 0;
  std::vector<std::string> refused;
  for (const auto& entry : fs::recursive_directory_iterator(sharedData("kalibr_results"))) {
    const std::string name = entry.path().filename().string();
    if (name.find("camchain") == std::string::npos || entry.path().extension() != ".yaml") continue;
    try {
      const Calibration rig = readCalibration(entry.path().string());
      EXPECT_FALSE(rig.cameras.empty()) << entry.path();
      EXPECT_EQ(rig.imu.has_value(), name.find("imucam") != std::string::npos) << entry.path();
      ++read;
    } catch (const InputError& error) {
      refused.emplace_back(error.what());
    }
  }
  EXPECT_EQ(read, 55);  // all that the folder holds (find -name "*camchain*.yaml")
  EXPECT_THAT(refused, testing::IsEmpty());
}

}  // namespace
}  // namespace plumbline
