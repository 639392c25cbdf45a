// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/calibration_reader.h"

#include "datasets/calibration/calibration_fields.h"
#include "datasets/calibration/kalibr/camchain.h"
#include "datasets/calibration/other_tools.h"
#include "datasets/files/yaml_map.h"

// JSON is a subset of YAML (1.2), so one reader serves both and names lines in both.
namespace plumbline {
namespace {

CameraCalibration ourCamera(const YamlMap& map) {
  CameraCalibration camera;
  camera.name = map.text("name", "a camera's name");
  camera.rostopic = map.textOr("rostopic", "");
  camera.intrinsics = intrinsicsField(map, {"model", "distortion"});
  camera.T_C0Ci = transformField(map, "T_C0Ci");
  const int n = static_cast<int>(camera.intrinsics.projection.size());
  const int m = static_cast<int>(camera.intrinsics.distortion.size());
  if (map.has("intrinsics_std")) {
    Eigen::VectorXd std(n + m);
    std << parametersField(map, "intrinsics_std", n),
        parametersField(map, "distortion_coeffs_std", m);
    camera.intrinsics_std = std;
  }
  if (map.has("T_C0Ci_std")) camera.T_C0Ci_std = parametersField(map, "T_C0Ci_std", 6);
  return camera;
}

ImuCalibration ourImu(const YamlMap& map) {
  ImuCalibration imu;
  imu.T_SC0 = transformField(map, "T_SC0");
  imu.time_offset_s = map.number("time_offset_s", "seconds");
  imu.gravity_m_s2 = map.number("gravity_m_s2", "metres per second squared");
  imu.rostopic = map.textOr("rostopic", "");
  if (map.has("T_SC0_std")) imu.T_SC0_std = parametersField(map, "T_SC0_std", 6);
  if (map.has("time_offset_std_s")) {
    imu.time_offset_std_s = map.number("time_offset_std_s", "seconds");
  }
  const YamlMap noise = map.map("noise", "noise densities");
  imu.noise.gyro_density = noise.number("gyroscope_noise_density", "rad/s/sqrt(Hz)");
  imu.noise.gyro_random_walk = noise.number("gyroscope_random_walk", "rad/s^2/sqrt(Hz)");
  imu.noise.accel_density = noise.number("accelerometer_noise_density", "m/s^2/sqrt(Hz)");
  imu.noise.accel_random_walk = noise.number("accelerometer_random_walk", "m/s^3/sqrt(Hz)");
  imu.noise.rate_hz = noise.number("update_rate", "Hz");
  return imu;
}

// They stand with the stage that estimated them; empty where all cameras share one.
std::vector<double> ourTimeOffsets(const YamlMap& file) {
  const char* key = "camera_time_offsets_s";
  if (!file.has("stages")) return {};
  const YamlMap stages = file.map("stages", "the stages' results");
  if (!stages.has("camera_imu")) return {};
  const YamlMap stage = stages.map("camera_imu", "the camera-IMU stage's results");
  return stage.has(key) ? stage.numbers(key, "seconds, one for each camera")
                        : std::vector<double>();
}

Calibration readOurs(const YamlMap& file) {
  if (file.integer("schema", "1") != 1) {
    throw file.fault("schema", {"unknown schema", "1", "use the version that wrote the file"});
  }
  Calibration calibration;
  for (const YamlMap& camera : file.maps("cameras", "a list of cameras")) {
    calibration.cameras.push_back(ourCamera(camera));
  }
  if (file.has("imu")) {
    calibration.imu = ourImu(file.map("imu", "the IMU"));
    calibration.imu->camera_time_offsets_s = ourTimeOffsets(file);
  }
  return calibration;
}

constexpr const char* kKnownCalibrations =
    "a calibration: Kalibr's camchain*.yaml (cam0: ...), our calibration.json, a result of yac, or "
    "Basalt's calibration.json";

}  // namespace

Calibration readCalibration(const std::string& path) {
  const std::string what = kKnownCalibrations;
  const YamlMap file = YamlMap::load(path, what);
  if (isYacResult(file)) return readYacResult(file);
  if (isBasaltCalibration(file)) return readBasaltCalibration(file);
  if (file.has("cam0")) return calibrationOf(readKalibrCamchain(path));
  if (file.has("schema") && file.has("cameras")) return readOurs(file);
  throw badInput(path, 1, {"this is no calibration that is known", what, ""});
}

bool statesImuNoise(const std::string& path) {
  const YamlMap file = YamlMap::load(path, kKnownCalibrations);
  return isYacResult(file) || isBasaltCalibration(file) || file.has("schema");
}

}  // namespace plumbline
