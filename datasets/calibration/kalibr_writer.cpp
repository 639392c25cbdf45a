// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/kalibr_writer.h"

#include <Eigen/Core>

#include <fmt/format.h>

#include "datasets/files/numbers.h"

namespace plumbline {
namespace {

std::string matrixText(const char* key, const Transform& T) {
  return fmt::format("  {}:\n", key) + yamlRows(T.matrix(), "  ");
}

std::string cameraText(const Calibration& calibration, std::size_t i, bool offset_known) {
  const CameraCalibration& camera = calibration.cameras[i];
  const Intrinsics& k = camera.intrinsics;
  std::string text = fmt::format("cam{}:\n", i);
  // Kalibr's transforms lead into the camera, ours out of it: T_CiS = (T_SC0 T_C0Ci)^-1 and
  // T_CiC(i-1) = T_C0Ci^-1 T_C0C(i-1).
  if (calibration.imu) {
    text += matrixText("T_cam_imu", (calibration.imu->T_SC0 * camera.T_C0Ci).inverse());
  }
  if (i > 0) {
    text += matrixText("T_cn_cnm1", camera.T_C0Ci.inverse() * calibration.cameras[i - 1].T_C0Ci);
  }
  text += fmt::format("  cam_overlaps: {}\n", kalibrOverlaps(i, calibration.cameras.size()));
  text += fmt::format("  camera_model: {}\n", toString(k.projection_model));
  text += fmt::format("  distortion_coeffs: {}\n", yamlList(k.distortion));
  text += fmt::format("  distortion_model: {}\n", toString(k.distortion_model));
  text += fmt::format("  intrinsics: {}\n", yamlList(k.projection));
  text += fmt::format("  resolution: [{}, {}]\n", k.resolution.width, k.resolution.height);
  const std::string topic = "/" + camera.name + "/image_raw";  // Kalibr demands one
  text +=
      fmt::format("  rostopic: {}\n", yamlText(camera.rostopic.empty() ? topic : camera.rostopic));
  if (calibration.imu && offset_known) {
    text += fmt::format("  timeshift_cam_imu: {}\n", yamlNumber(calibration.imu->timeOffset(i)));
  }
  return text;
}

}  // namespace

std::string kalibrDensities(const ImuNoise& noise, const std::string& indent) {
  std::string text;
  const auto add = [&](const char* key, double value) {
    text += fmt::format("{}{}: {}\n", indent, key, yamlNumber(value));
  };
  add("accelerometer_noise_density", noise.accel_density);
  add("accelerometer_random_walk", noise.accel_random_walk);
  add("gyroscope_noise_density", noise.gyro_density);
  add("gyroscope_random_walk", noise.gyro_random_walk);
  return text;
}

// All others, as a calibration does not say which cameras see the same.
std::string kalibrOverlaps(std::size_t camera, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    if (i != camera) text += (text.empty() ? "" : ", ") + std::to_string(i);
  }
  return "[" + text + "]";
}

std::string kalibrCamchainText(const Calibration& calibration, bool offset_known) {
  std::string text;
  for (std::size_t i = 0; i < calibration.cameras.size(); ++i) {
    text += cameraText(calibration, i, offset_known);
  }
  return text;
}

// T_i_b and time_offset relate an IMU to the rig's first, which this one is.
std::string kalibrImuText(const ImuNoise& noise, const std::string& rostopic) {
  return fmt::format(
      "imu0:\n{}{}  model: calibrated\n  rostopic: {}\n  time_offset: {}\n  update_rate: {}\n",
      matrixText("T_i_b", Transform()), kalibrDensities(noise, "  "),
      yamlText(rostopic.empty() ? "/imu0" : rostopic), yamlNumber(0), yamlNumber(noise.rate_hz));
}

std::string kalibrImuInputText(const ImuNoise& noise, const std::string& rostopic) {
  return fmt::format("{}rostopic: {}\nupdate_rate: {}\n", kalibrDensities(noise, ""),
                     yamlText(rostopic.empty() ? "/imu0" : rostopic), yamlNumber(noise.rate_hz));
}

std::string kalibrTargetText(const AprilGrid& target) {
  return fmt::format(
      "target_type: 'aprilgrid'\ntagCols: {}\ntagRows: {}\ntagSize: {}\ntagSpacing: {}\n",
      target.cols, target.rows, yamlNumber(target.tag_size), yamlNumber(target.spacing));
}

}  // namespace plumbline
