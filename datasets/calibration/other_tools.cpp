// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "datasets/calibration/calibration_fields.h"
#include "datasets/calibration/calibration_reader.h"

namespace plumbline {
namespace {

using Part = Implausible::Part;

constexpr const char* kPose = "px, py, pz, qx, qy, qz, qw";

Transform poseOf(const YamlMap& map) {
  const auto number = [&](const char* key) { return map.number(key, kPose); };
  // Hamilton; each component has a key of its own, so the file's order does not matter.
  const Eigen::Quaterniond q(number("qw"), number("qx"), number("qy"), number("qz"));
  // Rounded numbers pass; what is further off is no quaternion, or its numbers stand under other
  // keys.
  if (std::abs(q.norm() - 1) > 1e-3) {
    throw map.fault("qw", {InputFault::kNotRigid,
                           fmt::format("the quaternion's length is {:.4f}", q.norm()), "1"});
  }
  return {q, Eigen::Vector3d(number("px"), number("py"), number("pz"))};
}

// In the order of `keys`: our projections hold a model's own parameters first, then fx fy cx cy.
Eigen::VectorXd numbersOf(const YamlMap& map, std::initializer_list<const char*> keys) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(keys.size()));
  Eigen::Index i = 0;
  for (const char* key : keys) values(i++) = map.number(key, "a parameter of the camera");
  return values;
}

/// Whether any of the coefficients that radtan does not have is unlike zero.
/// Basalt has one type for both, OpenCV's rational model; without these it is radtan, which every
/// tool has.
bool isRational(const YamlMap& map) {
  return std::ranges::any_of(std::array{"k3", "k4", "k5", "k6"},
                             [&](const char* key) { return map.numberOr(key, 0) != 0; });
}

void setModel(Intrinsics& k, ProjectionModel projection, DistortionModel distortion) {
  k.projection_model = projection;
  k.distortion_model = distortion;
}

Intrinsics unified(const YamlMap& map, Intrinsics k) {
  setModel(k, ProjectionModel::kOmni, DistortionModel::kNone);
  // Basalt divides by alpha d + (1 - alpha) z, Kalibr's omni by z + xi d: the same with xi = alpha
  // / (1 - alpha) and focal lengths times 1 + xi.
  const double alpha = map.number("alpha", "between 0 and 1");
  const double xi = alpha / (1 - alpha);
  k.projection.resize(5);
  k.projection << xi, numbersOf(map, {"fx", "fy", "cx", "cy"});
  k.projection.segment<2>(1) *= 1 + xi;
  return k;
}

// rpmax is not read: our distortions find the radius up to which they are unique themselves
// (squaredRadiusLimit()).
// The numbers of ds, eucm and kb4 mean the same in Basalt and here; ucm and pinhole-radtan8 are
// translated.
Intrinsics intrinsicsOf(const YamlMap& camera) {
  const std::string type = camera.text("camera_type", "pinhole-radtan8, kb4, ds, ...");
  const YamlMap map = camera.map("intrinsics", "the camera's parameters");
  Intrinsics k;
  if (type == "ucm") return unified(map, k);
  if (type == "ds") {
    setModel(k, ProjectionModel::kDs, DistortionModel::kNone);
    k.projection = numbersOf(map, {"xi", "alpha", "fx", "fy", "cx", "cy"});
  } else if (type == "eucm") {
    setModel(k, ProjectionModel::kEucm, DistortionModel::kNone);
    k.projection = numbersOf(map, {"alpha", "beta", "fx", "fy", "cx", "cy"});
  } else {
    k.projection = numbersOf(map, {"fx", "fy", "cx", "cy"});
  }
  if (type == "pinhole-radtan8" && isRational(map)) {
    setModel(k, ProjectionModel::kPinhole, DistortionModel::kRational);
    k.distortion = numbersOf(map, {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"});
  } else if (type == "pinhole-radtan8") {
    setModel(k, ProjectionModel::kPinhole, DistortionModel::kRadtan);
    k.distortion = numbersOf(map, {"k1", "k2", "p1", "p2"});
  } else if (type == "kb4") {
    setModel(k, ProjectionModel::kPinhole, DistortionModel::kEquidistant);
    k.distortion = numbersOf(map, {"k1", "k2", "k3", "k4"});
  } else if (type == "pinhole") {
    setModel(k, ProjectionModel::kPinhole, DistortionModel::kNone);
  } else if (type != "ds" && type != "eucm") {
    throw camera.fault("camera_type",
                       {InputFault::kUnknownWord, "unknown camera_type '" + type + "'",
                        "pinhole, pinhole-radtan8, kb4, ds, eucm or ucm"});
  }
  return k;
}

/// Basalt has a density for each axis; here one serves all: the largest.
double largestOf(const YamlMap& map, const std::string& key) {
  const auto values = map.numbers(key, "three numbers, one for each axis");
  if (!values.empty()) return *std::max_element(values.begin(), values.end());
  throw map.fault(key, {InputFault::kEmpty, key + " is empty", "three numbers, one for each axis"});
}

ImuCalibration imuOf(const YamlMap& value, const Transform& T_SC0) {
  ImuCalibration imu;
  imu.T_SC0 = T_SC0;
  // Basalt's sign is ours.
  imu.time_offsets = {{1e-9 * value.number("cam_time_offset_ns", "nanoseconds")}};
  // Basalt's names say std, its values are continuous-time densities: it multiplies them by the
  // root of the rate itself. Gravity is not stated and keeps its default.
  imu.noise.rate_hz = value.number("imu_update_rate", "Hz");
  imu.noise.accel_density = largestOf(value, "accel_noise_std");
  imu.noise.gyro_density = largestOf(value, "gyro_noise_std");
  imu.noise.accel_random_walk = largestOf(value, "accel_bias_std");
  imu.noise.gyro_random_walk = largestOf(value, "gyro_bias_std");
  return imu;
}

CameraCalibration cameraOf(const YamlMap& file, int i) {
  CameraCalibration camera;
  camera.name = fmt::format("cam{}", i);
  camera.intrinsics = intrinsicsField(file.map(camera.name, "a camera"),
                                      {"proj_model", "dist_model", "proj_params", "dist_params"});
  // yac states camera 0 in the IMU, the others in camera 0.
  if (i > 0) camera.T_C0Ci = transformField(file, fmt::format("T_cam0_cam{}", i));
  refuseImplausible(file, implausible(camera), {{Part::kPlace, fmt::format("T_cam0_cam{}", i)}});
  return camera;
}

// Of yac: T_imu0_cam0 maps camera 0 into the IMU, as T_SC0 does; the sign of time_delay is ours,
// and sigma_*_c are continuous-time densities.
ImuCalibration imuOf(const YamlMap& file) {
  const YamlMap section = file.map("imu0", "the IMU's noise");
  ImuCalibration imu;
  imu.T_SC0 = transformField(file, "T_imu0_cam0");
  imu.time_offsets = {{file.number("time_delay", "seconds: imu_timestamp - camera_timestamp")}};
  imu.gravity_m_s2 = section.number("g", "metres per second squared");
  imu.noise.gyro_density = section.number("sigma_g_c", "rad/s/sqrt(Hz)");
  imu.noise.gyro_random_walk = section.number("sigma_gw_c", "rad/s^2/sqrt(Hz)");
  imu.noise.accel_density = section.number("sigma_a_c", "m/s^2/sqrt(Hz)");
  imu.noise.accel_random_walk = section.number("sigma_aw_c", "m/s^3/sqrt(Hz)");
  imu.noise.rate_hz = section.number("rate", "Hz");
  refuseImplausible(section, implausibleGravity(imu.gravity_m_s2), {{Part::kGravity, "g"}});
  // Without keys: place and offset stand outside of the section, so that its line is all that holds
  // for every part.
  refuseImplausible(section, implausible(imu), {});
  return imu;
}

}  // namespace

bool isBasaltCalibration(const YamlMap& file) {
  return file.hasMap("value0") && file.map("value0", "a calibration").has("T_imu_cam");
}

std::vector<std::string> basaltRemarks(const YamlMap& file) {
  const YamlMap value = file.map("value0", "a calibration");
  std::vector<std::string> remarks;
  for (const char* key : {"accel_noise_std", "gyro_noise_std", "accel_bias_std", "gyro_bias_std"}) {
    const auto values = value.numbers(key, "three numbers, one for each axis");
    const auto unlike = [&](double density) { return density != values.front(); };
    if (std::none_of(values.begin(), values.end(), unlike)) continue;
    remarks.push_back(std::string(key) + " differs between the axes: the largest serves all");
  }
  // Three biases, which are estimated anew, and behind them what would correct samples.
  for (const char* key : {"calib_accel_bias", "calib_gyro_bias"}) {
    if (!value.has(key)) continue;
    const auto values = value.numbers(key, "three biases, then scale and misalignment");
    if (std::none_of(values.begin() + std::min<std::ptrdiff_t>(3, std::ssize(values)), values.end(),
                     [](double v) { return v != 0; })) {
      continue;
    }
    remarks.push_back(
        std::string(key) +
        " states scale and misalignment of the IMU, which are not applied to samples");
  }
  return remarks;
}

Calibration readBasaltCalibration(const YamlMap& file) {
  const YamlMap value = file.map("value0", "a calibration");
  const auto poses = value.maps("T_imu_cam", "one pose for each camera");
  const auto cameras = value.maps("intrinsics", "one entry for each camera");
  const auto sizes = value.rows("resolution", "[width, height] for each camera");
  if (poses.size() != cameras.size() || sizes.size() != cameras.size() || poses.empty()) {
    throw value.fault("intrinsics", {InputFault::kContradiction,
                                     fmt::format("{} poses, {} cameras, {} resolutions",
                                                 poses.size(), cameras.size(), sizes.size()),
                                     "one of each for each camera"});
  }
  const Transform T_SC0 = poseOf(poses.front());
  Calibration calibration;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    CameraCalibration camera;
    camera.name = fmt::format("cam{}", i);
    camera.intrinsics = intrinsicsOf(cameras[i]);
    camera.intrinsics.resolution = resolutionOf(value, "resolution", sizes[i]);
    // Basalt states every camera in the IMU: T_C0Ci = T_SC0^-1 T_SCi.
    if (i > 0) camera.T_C0Ci = T_SC0.inverse() * poseOf(poses[i]);
    refuseImplausible(cameras[i], implausible(camera.intrinsics), {});
    // Of two poses that are too far apart either may be the wrong one.
    refuseImplausible(value, implausible(camera), {{Part::kPlace, "T_imu_cam"}});
    calibration.cameras.push_back(std::move(camera));
  }
  calibration.imu = imuOf(value, T_SC0);
  refuseImplausible(value, implausible(*calibration.imu),
                    {{Part::kOffset, "cam_time_offset_ns"},
                     {Part::kNoise, "accel_noise_std"},
                     {Part::kPlace, "T_imu_cam"}});
  return calibration;
}

// Kalibr's cameras have camera_model where yac's have proj_model.
bool isYacResult(const YamlMap& file) {
  return file.hasMap("cam0") && file.map("cam0", "a camera").has("proj_model");
}

Calibration readYacResult(const YamlMap& file) {
  Calibration calibration;
  const int count = file.countOf("cam");
  for (int i = 0; i < count; ++i) calibration.cameras.push_back(cameraOf(file, i));
  if (file.has("imu0")) calibration.imu = imuOf(file);
  return calibration;
}

}  // namespace plumbline
