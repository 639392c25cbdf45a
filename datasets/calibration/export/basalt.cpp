// SPDX-License-Identifier: BSD-3-Clause
// Names as basalt-headers' serialisation reads them. JSON has no comments: notes stand beside it.
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "calibrator/camera/radtan.h"
#include "calibrator/camera/rational.h"
#include "datasets/calibration/export/tools.h"

namespace plumbline {
namespace {

/// Up to where projection is unique, by the square of that radius; 0 (Basalt: no limit) if
/// everywhere.
double uniqueRadius(double squared) { return std::isfinite(squared) ? std::sqrt(squared) : 0; }

nlohmann::ordered_json pinholeOf(const Eigen::VectorXd& p) {
  return {{"fx", p[0]}, {"fy", p[1]}, {"cx", p[2]}, {"cy", p[3]}};
}

nlohmann::ordered_json cameraJson(const char* type, const nlohmann::ordered_json& intrinsics) {
  return {{"camera_type", type}, {"intrinsics", intrinsics}};
}

/// Radtan, of four coefficients, is the rational model with its denominator at 1.
nlohmann::ordered_json rationalJson(const Eigen::VectorXd& p, const Eigen::VectorXd& d,
                                    double squared_radius) {
  nlohmann::ordered_json k = pinholeOf(p);
  Eigen::Index i = 0;
  for (const char* name : {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}) {
    k[name] = i < d.size() ? d[i] : 0.0;
    ++i;
  }
  k["rpmax"] = uniqueRadius(squared_radius);
  return cameraJson("pinhole-radtan8", k);
}

nlohmann::ordered_json pinholeFamily(const CameraCalibration& camera, const ExportSource& source,
                                     const char* known) {
  const Intrinsics& k = camera.intrinsics;
  switch (k.distortion_model) {
    case DistortionModel::kNone:
      return cameraJson("pinhole", pinholeOf(k.projection));
    case DistortionModel::kRadtan:
      return rationalJson(k.projection, k.distortion,
                          Radtan::squaredRadiusLimit(k.distortion.data()));
    case DistortionModel::kEquidistant: {
      nlohmann::ordered_json kb4 = pinholeOf(k.projection);
      for (int i = 0; i < 4; ++i) kb4[fmt::format("k{}", i + 1)] = k.distortion[i];
      return cameraJson("kb4", kb4);
    }
    case DistortionModel::kRational:
      return rationalJson(k.projection, k.distortion,
                          Rational::squaredRadiusLimit(k.distortion.data()));
    case DistortionModel::kFov:
      break;
  }
  source.refuseModel(camera, known);
}

// Kalibr's omni divides by z + xi d, Basalt's ucm by alpha d + (1 - alpha) z: the same projection
// with alpha = xi / (1 + xi) and focal lengths over 1 + xi.
nlohmann::ordered_json unifiedOf(const Eigen::VectorXd& p) {
  const double xi = p[0];
  nlohmann::ordered_json k =
      pinholeOf(Eigen::Vector4d(p[1] / (1 + xi), p[2] / (1 + xi), p[3], p[4]));
  k["alpha"] = xi / (1 + xi);
  return cameraJson("ucm", k);
}

nlohmann::ordered_json intrinsicsJson(const CameraCalibration& camera, const ExportSource& source) {
  const char* known =
      "pinhole with radtan, equidistant, rational or no distortion; ds, eucm and omni without "
      "distortion";
  const Intrinsics& k = camera.intrinsics;
  if (k.projection_model == ProjectionModel::kPinhole) return pinholeFamily(camera, source, known);
  if (k.distortion_model != DistortionModel::kNone) source.refuseModel(camera, known);
  if (k.projection_model == ProjectionModel::kOmni) return unifiedOf(k.projection);
  const bool ds = k.projection_model == ProjectionModel::kDs;
  nlohmann::ordered_json json = pinholeOf(k.projection.tail(4));
  json[ds ? "xi" : "alpha"] = k.projection[0];
  json[ds ? "alpha" : "beta"] = k.projection[1];
  return cameraJson(ds ? "ds" : "eucm", json);
}

/// q and -q are one rotation; of the two the one with w >= 0 is written.
nlohmann::ordered_json poseJson(const Transform& T) {
  Eigen::Quaterniond q = T.quaternion();
  if (q.w() < 0) q.coeffs() *= -1;
  return {{"px", T.t.x()}, {"py", T.t.y()}, {"pz", T.t.z()}, {"qx", q.x()},
          {"qy", q.y()},   {"qz", q.z()},   {"qw", q.w()}};
}

std::vector<double> thrice(double value) { return {value, value, value}; }

nlohmann::ordered_json calibrationJson(const ExportSource& source) {
  const ImuCalibration& imu = source.neededImu();
  nlohmann::ordered_json json;
  for (const CameraCalibration& camera : source.calibration.cameras) {
    const Resolution& size = camera.intrinsics.resolution;
    json["T_imu_cam"].push_back(poseJson(imu.T_SC0 * camera.T_C0Ci));
    json["intrinsics"].push_back(intrinsicsJson(camera, source));
    json["resolution"].push_back({size.width, size.height});
  }
  // Basalt's lengths: three biases with six numbers of scale and misalignment, and with nine for
  // the gyroscope.
  json["calib_accel_bias"] = std::vector<double>(9, 0.0);
  json["calib_gyro_bias"] = std::vector<double>(12, 0.0);
  json["imu_update_rate"] = imu.noise.rate_hz;
  json["accel_noise_std"] = thrice(imu.noise.accel_density);
  json["gyro_noise_std"] = thrice(imu.noise.gyro_density);
  json["accel_bias_std"] = thrice(imu.noise.accel_random_walk);
  json["gyro_bias_std"] = thrice(imu.noise.gyro_random_walk);
  // Camera 0's, of Basalt's one offset; offsetWarnings() says what the others need.
  json["cam_time_offset_ns"] = nanosecondsOf(imu.timeOffset());
  json["vignette"] = nlohmann::ordered_json::array();
  return {{"value0", json}};
}

std::vector<std::string> basaltWarnings(const ExportSource& source) {
  const auto& [calibration, options, tool] = source;
  std::vector<std::string> warnings = offsetWarnings(source, "cam_time_offset_ns is written as 0.");
  if (options.offset_known) {
    warnings.push_back(
        "In the Basalt sources looked at, the line that would add cam_time_offset_ns is commented "
        "out: check yours; if it is, add " +
        secondsText(calibration.imu->timeOffset()) +
        " to every image stamp and set cam_time_offset_ns to 0.");
  }
  for (const CameraCalibration& camera : calibration.cameras) {
    if (!isPinhole(camera.intrinsics, DistortionModel::kRadtan)) continue;
    warnings.push_back(
        "radtan is written as pinhole-radtan8 with k3 to k6 zero, which is the same projection; "
        "older versions of basalt-headers lack that model (they have pinhole, kb4, ds, eucm and "
        "ucm).");
    break;
  }
  return warnings;
}

std::string notesText(const ExportOptions& options, const std::vector<std::string>& warnings) {
  std::vector<std::string> notes{
      provenanceLine(options),
      "T_imu_cam maps camera to IMU (quaternion: Hamilton, x y z w). t_imu = t_cam + "
      "cam_time_offset_ns, in whole nanoseconds.",
      "Noise: continuous-time densities; Basalt multiplies by the root of imu_update_rate itself. "
      "Scale, misalignment and biases (calib_accel_bias, calib_gyro_bias) are zero: not "
      "calibrated. rpmax: up to this radius the distortion is unique; 0 means everywhere."};
  notes.insert(notes.end(), warnings.begin(), warnings.end());
  return wrapped(notes, "");
}

}  // namespace

ExportedFiles exportBasalt(const ExportSource& source) {
  const std::string json = calibrationJson(source).dump(2) + "\n";
  ExportedFiles out;
  out.warnings = basaltWarnings(source);
  out.files = {{"basalt_calib.json", json},
               {"basalt_notes.txt", notesText(source.options, out.warnings)}};
  return out;
}

}  // namespace plumbline
