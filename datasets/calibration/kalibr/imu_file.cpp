// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/kalibr/imu_file.h"

#include <utility>

#include <fmt/format.h>

#include "datasets/calibration/calibration_fields.h"
#include "datasets/files/yaml_map.h"

namespace plumbline {
namespace {

constexpr const char* kWhat = "Kalibr's imu.yaml (update_rate and noise densities, or imu0: ...)";

double positive(const YamlMap& map, const std::string& key, const std::string& unit) {
  const double value = map.number(key, "a positive number [" + unit + "]");
  if (value > 0) return value;
  throw map.fault(key,
                  {fmt::format("{} is {:g}", key, value), "a positive number [" + unit + "]", ""});
}

std::optional<Eigen::Matrix3d> matrixOf(const YamlMap& imu, const std::string& sensor,
                                        const std::string& key) {
  if (!imu.has(sensor)) return std::nullopt;
  const YamlMap map = imu.map(sensor, "a mapping");
  if (!map.has(key)) return std::nullopt;
  const auto rows = map.rows(key, "a 3x3 matrix, as rows");
  Eigen::Matrix3d M;
  if (rows.size() != 3) throw map.fault(key, {key + " is not 3x3", "three rows of three", ""});
  for (int r = 0; r < 3; ++r) {
    if (rows[r].size() != 3) throw map.fault(key, {key + " is not 3x3", "three rows of three", ""});
    for (int c = 0; c < 3; ++c) M(r, c) = rows[r][c];
  }
  return M;
}

KalibrImu imuOf(const YamlMap& map, const std::string& name) {
  KalibrImu imu;
  imu.name = name;
  imu.rostopic = map.textOr("rostopic", "");
  imu.model = map.textOr("model", "calibrated");
  imu.noise.accel_density = positive(map, "accelerometer_noise_density", "m/s^2/sqrt(Hz)");
  imu.noise.accel_random_walk = positive(map, "accelerometer_random_walk", "m/s^3/sqrt(Hz)");
  imu.noise.gyro_density = positive(map, "gyroscope_noise_density", "rad/s/sqrt(Hz)");
  imu.noise.gyro_random_walk = positive(map, "gyroscope_random_walk", "rad/s^2/sqrt(Hz)");
  imu.noise.rate_hz = positive(map, "update_rate", "Hz");
  if (map.has("T_i_b")) imu.T_i_b = transformField(map, "T_i_b");
  imu.time_offset_s = map.numberOr("time_offset", 0);
  imu.accel_M = matrixOf(map, "accelerometers", "M");
  imu.gyro_M = matrixOf(map, "gyroscopes", "M");
  imu.gyro_A = matrixOf(map, "gyroscopes", "A");
  imu.C_gyro_i = matrixOf(map, "gyroscopes", "C_gyro_i");
  return imu;
}

}  // namespace

KalibrImuFile readKalibrImus(const std::string& path) {
  const YamlMap file = YamlMap::load(path, kWhat);
  KalibrImuFile read;
  read.path = path;
  read.wrapped = file.has("imu0");
  if (!read.wrapped) {
    read.imus.push_back(imuOf(file, "imu0"));
    return read;
  }
  for (int i = 0; file.has(fmt::format("imu{}", i)); ++i) {
    const std::string name = fmt::format("imu{}", i);
    read.imus.push_back(imuOf(file.map(name, "an IMU"), name));
  }
  return read;
}

}  // namespace plumbline
