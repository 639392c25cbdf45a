// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/yac_result.h"

#include <utility>

#include <fmt/format.h>

#include "datasets/calibration/calibration_fields.h"

namespace plumbline {
namespace {

CameraCalibration cameraOf(const YamlMap& file, int i) {
  CameraCalibration camera;
  camera.name = fmt::format("cam{}", i);
  camera.intrinsics = intrinsicsField(file.map(camera.name, "a camera"),
                                      {"proj_model", "dist_model", "proj_params", "dist_params"});
  if (i > 0) camera.T_C0Ci = transformField(file, fmt::format("T_cam0_cam{}", i));
  return camera;
}

ImuCalibration imuOf(const YamlMap& file) {
  const YamlMap section = file.map("imu0", "the IMU's noise");
  ImuCalibration imu;
  imu.T_SC0 = transformField(file, "T_imu0_cam0");
  imu.time_offset_s = file.number("time_delay", "seconds: imu_timestamp - camera_timestamp");
  imu.gravity_m_s2 = section.number("g", "metres per second squared");
  imu.noise.gyro_density = section.number("sigma_g_c", "rad/s/sqrt(Hz)");
  imu.noise.gyro_random_walk = section.number("sigma_gw_c", "rad/s^2/sqrt(Hz)");
  imu.noise.accel_density = section.number("sigma_a_c", "m/s^2/sqrt(Hz)");
  imu.noise.accel_random_walk = section.number("sigma_aw_c", "m/s^3/sqrt(Hz)");
  imu.noise.rate_hz = section.number("rate", "Hz");
  return imu;
}

}  // namespace

bool isYacResult(const YamlMap& file) {
  return file.has("cam0") && file.node("cam0").IsMap() &&
         file.map("cam0", "a camera").has("proj_model");
}

Calibration readYacResult(const YamlMap& file) {
  Calibration calibration;
  for (int i = 0; file.has(fmt::format("cam{}", i)); ++i) {
    calibration.cameras.push_back(cameraOf(file, i));
  }
  if (file.has("imu0")) calibration.imu = imuOf(file);
  return calibration;
}

}  // namespace plumbline
