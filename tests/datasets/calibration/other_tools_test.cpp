// SPDX-License-Identifier: BSD-3-Clause
// A calibration in Basalt's own words, written by hand, so that a reader and a writer that are
// wrong alike do not agree here.
#include <string>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "datasets/calibration/calibration_reader.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

// Camera 0 a quarter turn about z in the IMU; camera 1 is 0.1 m along the IMU's y, turned alike. No
// two numbers are equal that might be mixed up.
constexpr const char* kBasalt = R"({"value0": {
  "T_imu_cam": [
    {"px": 0.01, "py": 0.02, "pz": 0.03, "qx": 0, "qy": 0, "qz": 0.7071068, "qw": 0.7071068},
    {"px": 0.01, "py": 0.12, "pz": 0.03, "qx": 0, "qy": 0, "qz": 0.7071068, "qw": 0.7071068}],
  "intrinsics": [
    {"camera_type": "pinhole-radtan8", "intrinsics": {"fx": 400, "fy": 410, "cx": 320, "cy": 240,
      "k1": 0.3, "k2": -0.05, "p1": 0.001, "p2": -0.002, "k3": 0.004, "k4": 0.6, "k5": 0.02,
      "k6": 0.003, "rpmax": 2.5}},
    {"camera_type": "pinhole-radtan8", "intrinsics": {"fx": 401, "fy": 411, "cx": 321, "cy": 241,
      "k1": -0.3, "k2": 0.07, "p1": 0.001, "p2": -0.002, "k3": 0, "k4": 0, "k5": 0, "k6": 0,
      "rpmax": 0}}],
  "resolution": [[640, 480], [752, 481]],
  "imu_update_rate": 250,
  "accel_noise_std": [0.016, 0.016, 0.016],
  "gyro_noise_std": [0.00028, 0.00028, 0.00028],
  "accel_bias_std": [0.0011, 0.0011, 0.0011],
  "gyro_bias_std": [0.00009, 0.00009, 0.00009],
  "cam_time_offset_ns": -1500000}})";

class BasaltFile : public testing::Test {
 protected:
  Calibration read(const std::string& text) const {
    return readCalibration(folder_.write("calibration.json", text));
  }
  /// The fault of the file with its first `from` replaced.
  std::optional<BadInput> refusalWith(const std::string& from, const std::string& to) const {
    std::string text = kBasalt;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    return refusalOf([&] { (void)read(text); });
  }
  TemporaryFolder folder_;
};

TEST_F(BasaltFile, PosesLeadFromCameraToImu) {
  const Calibration c = read(kBasalt);
  Eigen::Matrix3d quarter;
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  EXPECT_LT((c.imu->T_SC0.R - quarter).norm(), 1e-9);
  EXPECT_EQ(c.imu->T_SC0.t, Eigen::Vector3d(0.01, 0.02, 0.03));
  // The IMU's y is camera 0's x.
  EXPECT_LT((c.cameras[1].T_C0Ci.t - Eigen::Vector3d(0.1, 0, 0)).norm(), 1e-9);
  EXPECT_LT((c.cameras[1].T_C0Ci.R - Eigen::Matrix3d::Identity()).norm(), 1e-9);
  EXPECT_EQ(c.cameras[1].intrinsics.resolution, (Resolution{752, 481}));
}

TEST_F(BasaltFile, OffsetAndDensitiesHaveTheirOwnPlaces) {
  const ImuCalibration imu = *read(kBasalt).imu;
  EXPECT_DOUBLE_EQ(imu.timeOffset(), -0.0015);  // t_imu = t_cam + cam_time_offset_ns
  EXPECT_EQ(imu.noise.rate_hz, 250);
  EXPECT_EQ(imu.noise.accel_density, 0.016);
  EXPECT_EQ(imu.noise.gyro_density, 0.00028);
  EXPECT_EQ(imu.noise.accel_random_walk, 0.0011);
  EXPECT_EQ(imu.noise.gyro_random_walk, 0.00009);
}

// radtan8 is OpenCV's rational model, whose coefficients stand in the order k1 k2 p1 p2 k3 .. k6.
TEST_F(BasaltFile, Radtan8MeetsOpencvsPixels) {
  const Calibration c = read(kBasalt);
  EXPECT_EQ(c.cameras[0].intrinsics.distortion_model, DistortionModel::kRational);
  EXPECT_EQ(c.cameras[1].intrinsics.distortion_model, DistortionModel::kRadtan);
  const cv::Matx33d K(400, 0, 320, 0, 410, 240, 0, 0, 1);
  const std::vector<double> d{0.3, -0.05, 0.001, -0.002, 0.004, 0.6, 0.02, 0.003};
  for (const double x : {-0.7, -0.2, 0.4}) {
    std::vector<cv::Point2d> uv;
    cv::projectPoints(std::vector<cv::Point3d>{{x, 0.3, 1}}, cv::Vec3d(), cv::Vec3d(), K, d, uv);
    const auto pixel = project(c.cameras[0].intrinsics, {x, 0.3, 1});
    ASSERT_TRUE(pixel);
    EXPECT_LT((*pixel - Eigen::Vector2d(uv[0].x, uv[0].y)).norm(), 1e-9);
  }
}

TEST_F(BasaltFile, FaultsNameTheirLine) {
  const struct {
    const char* from;
    const char* to;
    int line;
    InputFault code;
  } cases[] = {
      // Two components that were swapped, or a quaternion that was cut, are no longer of length 1.
      {R"("qw": 0.7071068)", R"("qw": 0.7171068)", 3, InputFault::kNotRigid},
      {R"("camera_type": "pinhole-radtan8")", R"("camera_type": "radtan8")", 6,
       InputFault::kUnknownWord},
      {"[[640, 480], [752, 481]]", "[[640, 480]]", 5, InputFault::kContradiction},
      {"[640, 480]", "[640.5, 480]", 12, InputFault::kBadNumber},
      {"[0.016, 0.016, 0.016]", "[]", 14, InputFault::kEmpty},
      {R"("px": 0.01)", R"("px": 10000)", 2, InputFault::kOutOfRange},
      {R"("fx": 401)", R"("fx": -401)", 9, InputFault::kOutOfRange},
      {"-1500000", "-1.5e15", 18, InputFault::kOutOfRange},
  };
  for (const auto& c : cases) {
    const auto refusal = refusalWith(c.from, c.to);
    ASSERT_TRUE(refusal) << c.to;
    EXPECT_EQ(refusal->code(), c.code) << refusal->what();
    EXPECT_EQ(refusal->line(), c.line) << refusal->what();
  }
}

}  // namespace
}  // namespace plumbline
