// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration_reader.h"

#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "datasets/internal/mapped_file.h"
#include "datasets/internal/yaml_map.h"

// JSON is a subset of YAML (1.2), so one reader serves both and names lines in both.
namespace plumbline {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr const char* kMatrix = "four rows of four numbers: a homogeneous transform";

Eigen::VectorXd vectorOf(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

Transform transformOf(const YamlMap& map, const std::string& key) {
  const auto rows = map.rows(key, kMatrix);
  Eigen::Matrix4d T = Eigen::Matrix4d::Constant(std::nan(""));
  if (rows.size() == 4) {
    for (int r = 0; r < 4; ++r) {
      if (rows[r].size() != 4) break;
      for (int c = 0; c < 4; ++c) T(r, c) = rows[r][c];
    }
  }
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  const bool rotation = (R * R.transpose()).isIdentity(1e-3) && R.determinant() > 0;
  if (T.allFinite() && rotation && T.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1))) {
    return Transform::fromMatrix(T);
  }
  throw map.fault(key, {key + " is not a rigid transform", kMatrix,
                        "copy the matrix again without rounding; its upper left 3x3 block must be "
                        "a rotation"});
}

template <class Model>
Model modelOf(const YamlMap& map, const std::string& key, const std::string& word,
              const std::optional<Model>& model, const std::string& known) {
  if (model) return *model;
  throw map.fault(key, {"unknown " + key + " '" + word + "'", "one of " + known, ""});
}

Eigen::VectorXd parameters(const YamlMap& map, const std::string& key, std::size_t count) {
  const auto values =
      count == 0 && !map.has(key) ? std::vector<double>() : map.numbers(key, "a list of numbers");
  if (values.size() == count) return vectorOf(values);
  throw map.fault(key, {fmt::format("{} has {} numbers", key, values.size()),
                        fmt::format("{} for this model", count), "copy the line again"});
}

std::size_t projectionCount(ProjectionModel model) {
  switch (model) {
    case ProjectionModel::kPinhole:
      return 4;
    case ProjectionModel::kOmni:
      return 5;
    case ProjectionModel::kEucm:
    case ProjectionModel::kDs:
      return 6;
  }
  return 4;
}

std::size_t distortionCount(DistortionModel model) {
  switch (model) {
    case DistortionModel::kNone:
      return 0;
    case DistortionModel::kFov:
      return 1;
    case DistortionModel::kRadtan:
    case DistortionModel::kEquidistant:
      return 4;
  }
  return 0;
}

struct ModelKeys {
  const char* projection;
  const char* distortion;
};

Intrinsics intrinsicsOf(const YamlMap& map, const ModelKeys& keys) {
  Intrinsics k;
  const std::string projection = map.text(keys.projection, "pinhole, omni, eucm or ds");
  const std::string distortion = map.text(keys.distortion, "radtan, equidistant, fov or none");
  k.projection_model = modelOf(map, keys.projection, projection, projectionModelFrom(projection),
                               "pinhole, omni, eucm, ds");
  k.distortion_model = modelOf(map, keys.distortion, distortion, distortionModelFrom(distortion),
                               "radtan, equidistant, fov, none");
  k.projection = parameters(map, "intrinsics", projectionCount(k.projection_model));
  k.distortion = parameters(map, "distortion_coeffs", distortionCount(k.distortion_model));
  const auto size = map.numbers("resolution", "[width, height] in pixels");
  if (size.size() != 2 || size[0] < 1 || size[1] < 1) {
    throw map.fault("resolution",
                    {"resolution is not two positive numbers", "[width, height]", ""});
  }
  k.resolution = {static_cast<int>(size[0]), static_cast<int>(size[1])};
  return k;
}

// ---- Kalibr's camchain

void refuseRollingShutter(const YamlMap& map) {
  if (!map.has("line_delay") || map.number("line_delay", "seconds a row") == 0) return;
  throw map.fault("line_delay", {"a rolling shutter (line_delay is not 0)", "a global shutter",
                                 "rolling shutters are not supported yet"});
}

// T_C0Ci from the chain and, where both are there, checked against T_cam_imu.
Transform placeInChain(const YamlMap& map, const std::vector<CameraCalibration>& before,
                       const std::optional<Transform>& T_C0S) {
  std::optional<Transform> chained;
  if (before.empty()) {
    chained = Transform();
  } else if (map.has("T_cn_cnm1")) {
    chained = before.back().T_C0Ci * transformOf(map, "T_cn_cnm1").inverse();
  }
  if (!map.has("T_cam_imu") || !T_C0S) {
    if (chained) return *chained;
    throw map.fault("T_cn_cnm1", {"neither T_cn_cnm1 nor T_cam_imu is there", kMatrix,
                                  "without one of them this camera's place is unknown"});
  }
  const Transform by_imu = *T_C0S * transformOf(map, "T_cam_imu").inverse();
  if (!chained) return by_imu;
  const Vector6d difference = boxminus(by_imu, *chained);
  if (difference.head<3>().norm() > 1e-3 || difference.tail<3>().norm() > 0.1 * kDegree) {
    throw map.fault(
        "T_cam_imu",
        {fmt::format("T_cam_imu and T_cn_cnm1 contradict each other by {:.1f} mm and "
                     "{:.2f} degrees",
                     1e3 * difference.head<3>().norm(), difference.tail<3>().norm() / kDegree),
         "T_cam_imu mapping IMU to camera, T_cn_cnm1 the previous camera to this one",
         "one of them may be inverted, or from another calibration"});
  }
  return *chained;
}

Calibration readCamchain(const YamlMap& file) {
  Calibration calibration;
  std::optional<Transform> T_C0S;
  double shifts = 0;
  int shift_count = 0;
  for (int i = 0; file.has(fmt::format("cam{}", i)); ++i) {
    const YamlMap map = file.map(fmt::format("cam{}", i), "a camera");
    refuseRollingShutter(map);
    CameraCalibration camera;
    camera.name = fmt::format("cam{}", i);
    camera.rostopic = map.textOr("rostopic", "");
    camera.intrinsics = intrinsicsOf(map, {"camera_model", "distortion_model"});
    if (i == 0 && map.has("T_cam_imu")) T_C0S = transformOf(map, "T_cam_imu");
    camera.T_C0Ci = placeInChain(map, calibration.cameras, T_C0S);
    if (map.has("timeshift_cam_imu")) {
      shifts += map.number("timeshift_cam_imu", "seconds");
      ++shift_count;
    }
    calibration.cameras.push_back(std::move(camera));
  }
  if (T_C0S) {
    calibration.imu.emplace();
    calibration.imu->T_SC0 = T_C0S->inverse();
    if (shift_count > 0) calibration.imu->time_offset_s = shifts / shift_count;
  }
  return calibration;
}

// ---- our calibration.json

CameraCalibration ourCamera(const YamlMap& map) {
  CameraCalibration camera;
  camera.name = map.text("name", "a camera's name");
  camera.rostopic = map.textOr("rostopic", "");
  camera.intrinsics = intrinsicsOf(map, {"model", "distortion"});
  camera.T_C0Ci = transformOf(map, "T_C0Ci");
  const int n = static_cast<int>(camera.intrinsics.projection.size());
  const int m = static_cast<int>(camera.intrinsics.distortion.size());
  if (map.has("intrinsics_std")) {
    Eigen::VectorXd std(n + m);
    std << parameters(map, "intrinsics_std", n), parameters(map, "distortion_coeffs_std", m);
    camera.intrinsics_std = std;
  }
  if (map.has("T_C0Ci_std")) camera.T_C0Ci_std = parameters(map, "T_C0Ci_std", 6);
  return camera;
}

ImuCalibration ourImu(const YamlMap& map) {
  ImuCalibration imu;
  imu.T_SC0 = transformOf(map, "T_SC0");
  imu.time_offset_s = map.number("time_offset_s", "seconds");
  imu.gravity_m_s2 = map.number("gravity_m_s2", "metres per second squared");
  imu.rostopic = map.textOr("rostopic", "");
  if (map.has("T_SC0_std")) imu.T_SC0_std = parameters(map, "T_SC0_std", 6);
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

}  // namespace

Calibration readCalibration(const std::string& path) {
  const std::string what =
      "a calibration: Kalibr's camchain*.yaml (cam0: ...) or our calibration.json";
  const YamlMap file = YamlMap::load(path, what);
  if (file.has("cam0")) return readCamchain(file);
  if (file.has("schema") && file.has("cameras")) return readOurs(file);
  throw badInput(path, 1, {"this is no calibration that is known", what, ""});
}

}  // namespace plumbline
