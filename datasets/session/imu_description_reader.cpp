// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include <fmt/format.h>

#include "datasets/files/yaml_map.h"
#include "datasets/session/imu_reader.h"

namespace plumbline {
namespace {

constexpr const char* kImuKeys =
    "update_rate [Hz] and accelerometer_noise_density, accelerometer_random_walk, "
    "gyroscope_noise_density, gyroscope_random_walk (continuous-time densities), flat or below "
    "imu0:";
constexpr const char* kRefusedModel =
    "IMU scale and misalignment are not supported yet (they would be ignored silently)";

double positive(const YamlMap& imu, const std::string& key, const std::string& unit) {
  const double value = imu.number(key, "a positive number [" + unit + "]");
  if (value > 0) return value;
  throw imu.fault(key, {fmt::format("{} is {:g}", key, value), "a positive number [" + unit + "]",
                        "take it from the data sheet or an Allan deviation; it weighs the IMU"});
}

bool isIdentity(const std::vector<std::vector<double>>& rows) {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t c = 0; c < rows[r].size(); ++c) {
      if (std::abs(rows[r][c] - (r == c ? 1.0 : 0.0)) > 1e-9) return false;
    }
  }
  return true;
}

void refuseMatrix(const YamlMap& imu, const std::string& sensor, const std::string& key) {
  if (!imu.has(sensor)) return;
  const YamlMap map = imu.map(sensor, "a mapping");
  if (map.has(key) && !isIdentity(map.rows(key, "a 3x3 matrix, as rows"))) {
    throw map.fault(key, {sensor + "." + key + " is not the identity", "model: calibrated",
                          std::string(kRefusedModel) + "; calibrate with model: calibrated"});
  }
}

void refuseModels(const YamlMap& imu) {
  const std::string model = imu.textOr("model", "calibrated");
  if (model != "calibrated") {
    throw imu.fault("model", {"the IMU model is '" + model + "'", "model: calibrated",
                              std::string(kRefusedModel) + "; calibrate with model: calibrated"});
  }
  refuseMatrix(imu, "accelerometers", "M");
  refuseMatrix(imu, "gyroscopes", "M");
}

YamlMap unwrapped(const YamlMap& file) {
  for (const std::string& key : file.keys()) {
    if (key.rfind("imu", 0) == 0 && key != "imu0" && file.node(key).IsMap()) {
      throw file.fault(key, {"the file describes a second IMU ('" + key + "')", "one IMU, imu0",
                             "delete the other IMUs"});
    }
  }
  return file.has("imu0") ? file.map("imu0", kImuKeys) : file;
}

}  // namespace

ImuDescription readImuDescription(const std::string& path) {
  const YamlMap file = YamlMap::load(path, kImuKeys);
  const YamlMap imu = unwrapped(file);
  refuseModels(imu);
  ImuDescription description;
  ImuNoise& noise = description.noise;
  noise.accel_density = positive(imu, "accelerometer_noise_density", "m/s^2/sqrt(Hz)");
  noise.accel_random_walk = positive(imu, "accelerometer_random_walk", "m/s^3/sqrt(Hz)");
  noise.gyro_density = positive(imu, "gyroscope_noise_density", "rad/s/sqrt(Hz)");
  noise.gyro_random_walk = positive(imu, "gyroscope_random_walk", "rad/s^2/sqrt(Hz)");
  const bool euroc = imu.has("rate_hz") && !imu.has("update_rate");
  noise.rate_hz = positive(imu, euroc ? "rate_hz" : "update_rate", "Hz");
  description.rostopic = imu.textOr("rostopic", "");
  return description;
}

}  // namespace plumbline
