// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "datasets/calibration/kalibr/results_lines.h"
#include "datasets/calibration/kalibr/run.h"
#include "datasets/files/file_io.h"

namespace plumbline {
namespace {

constexpr const char* kNoise = "the noise densities of 'IMU configuration'";

// The camera that the text of a line names: "cam1" in "Reprojection error (cam1):".
KalibrTextCamera& cameraNamed(KalibrResults& results, const ResultsLines& lines) {
  const std::string name = lines.cameraName();
  for (KalibrTextCamera& camera : results.cameras) {
    if (camera.name == name) return camera;
  }
  if (name.empty())
    throw lines.fault("no camera is named here", "cam0, cam1, ...", InputFault::kMissingKey);
  results.cameras.emplace_back();
  results.cameras.back().name = name;
  return results.cameras.back();
}

KalibrErrorStatistics statisticsOf(const ResultsLines& lines) {
  KalibrErrorStatistics s;
  s.mean = lines.numberAfter("mean ");
  s.median = lines.numberAfter("median ", "median: ");
  s.std = lines.numberAfter("std: ");
  return s;
}

/// Errors in units have them in brackets ("[px]"). Without brackets they are normalised by the
/// assumed noise, and of squares in old versions: none of ours is compared with them.
void readErrorLine(KalibrResults& results, const ResultsLines& lines) {
  if (lines.contains("no corners")) return;
  const KalibrErrorStatistics s = statisticsOf(lines);
  const bool raw = lines.contains("[");
  if (lines.startsWith("Reprojection")) {
    KalibrTextCamera& camera = cameraNamed(results, lines);
    if (raw) camera.error_px = s;
  } else if (raw) {
    // Of the first IMU, as the noise.
    auto& imu = lines.startsWith("Gyro") ? results.gyro_rad_s : results.accel_m_s2;
    if (!imu) imu = s;
  }
}

Transform matrixOf(ResultsLines& lines) {
  const std::vector<double> numbers = lines.bracket(16);
  const Eigen::Matrix4d T =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data());
  return Transform::fromMatrix(T);
}

Eigen::VectorXd vectorOf(const std::vector<double>& numbers) {
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(),
                                           static_cast<Eigen::Index>(numbers.size()));
}

// "[mean] +- [std]": numpy's mean and std (ddof 0) per axis over all corners of the camera (Kalibr,
// CameraCalibrator.py, getReprojectionErrorStatistics()).
KalibrAxisStatistics axisStatistics(ResultsLines& lines) {
  KalibrAxisStatistics s;
  s.mean = vectorOf(lines.bracket(2));
  s.std = vectorOf(lines.bracket(2));
  return s;
}

// ---- the camera tool

Transform baselineOf(ResultsLines& lines) {
  // Each is followed by "+- [deviations]", which the next skipTo() passes over.
  lines.skipTo("q:");
  const std::vector<double> q = lines.bracket(4);
  lines.skipTo("t:");
  const std::vector<double> t = lines.bracket(3);
  // x, y, z, w of the conjugate (JPL), as in the table of poses; the text states no order.
  return {Eigen::Quaterniond(q[3], -q[0], -q[1], -q[2]), Eigen::Vector3d(t[0], t[1], t[2])};
}

void readCameraToolLine(KalibrResults& results, ResultsLines& lines) {
  if (lines.startsWith("cam") && lines.contains("(") && lines.contains("):")) {
    KalibrTextCamera& camera = cameraNamed(results, lines);
    camera.rostopic = lines.between('(', ')');
    return;
  }
  if (lines.startsWith("baseline T_")) {
    const double to = lines.numberAfter("baseline T_");
    if (!(to >= 1 && to < static_cast<double>(results.cameras.size())) || to != std::floor(to)) {
      throw lines.fault("a baseline of a camera that is not listed", "baseline T_1_0");
    }
    results.cameras[static_cast<std::size_t>(to)].T_cn_cnm1 = baselineOf(lines);
    return;
  }
  if (results.cameras.empty()) return;
  KalibrTextCamera& camera = results.cameras.back();
  if (lines.startsWith("distortion:")) {
    camera.distortion = vectorOf(lines.bracket());
    camera.distortion_std = vectorOf(lines.bracket());
  } else if (lines.startsWith("projection:")) {
    camera.projection = vectorOf(lines.bracket());
    camera.projection_std = vectorOf(lines.bracket());
  } else if (lines.startsWith("reprojection error:")) {
    camera.axis_error_px = axisStatistics(lines);
  }
}

/// A text that was cut is refused rather than taken for one of fewer cameras.
void requireCameraTool(const KalibrResults& results, const ResultsLines& lines) {
  for (const KalibrTextCamera& camera : results.cameras) {
    if (camera.projection.size() == 0) throw lines.ended(camera.name + "'s projection");
    if (!camera.axis_error_px) throw lines.ended(camera.name + "'s reprojection error");
  }
  if (results.cameras.empty()) throw lines.ended("the cameras' parameters");
  // The section that ends the text.
  if (!lines.sawLine("Target configuration")) throw lines.ended("'Target configuration'");
}

// ---- the camera-IMU tool

// The IMU's section lists first the accelerometer's densities, then the gyroscope's.
ImuNoise noiseOf(ResultsLines& lines) {
  ImuNoise noise;
  const auto valueOf = [&](const char* key) {
    if (!lines.skipTo(key)) throw lines.ended(kNoise);
    return lines.numberAfter(key);
  };
  if (!lines.skipTo("Update rate:")) throw lines.ended(kNoise);
  noise.rate_hz = lines.numberAfter("Update rate:");
  if (!lines.skipTo("Accelerometer:")) throw lines.ended(kNoise);
  noise.accel_density = valueOf("Noise density:");
  noise.accel_random_walk = valueOf("Random walk:");
  if (!lines.skipTo("Gyroscope:")) throw lines.ended(kNoise);
  noise.gyro_density = valueOf("Noise density:");
  noise.gyro_random_walk = valueOf("Random walk:");
  return noise;
}

void readImuToolLine(KalibrResults& results, ResultsLines& lines) {
  // "error" or "Error", whichever the layout has.
  if (lines.contains("rror") && lines.contains("(") &&
      (lines.startsWith("Reprojection") || lines.startsWith("Gyro") ||
       lines.startsWith("Accelerometer error"))) {
    readErrorLine(results, lines);
  } else if (lines.startsWith("T_ci:")) {
    KalibrTextCamera& camera = cameraNamed(results, lines);
    lines.next();
    camera.T_cam_imu = matrixOf(lines);
  } else if (lines.startsWith("timeshift cam")) {
    KalibrTextCamera& camera = cameraNamed(results, lines);
    if (!lines.next()) throw lines.ended("the time shift");
    camera.timeshift_cam_imu = lines.numberAfter("");
  } else if (lines.startsWith("Gravity vector")) {
    lines.next();
    results.gravity_F = vectorOf(lines.bracket(3));
  } else if (lines.startsWith("IMU configuration") && !results.noise) {
    // Of the first IMU, by which the rig goes; others have sections of their own.
    results.noise = noiseOf(lines);
  }
}

void requireImuTool(const KalibrResults& results, const ResultsLines& lines) {
  if (results.cameras.empty()) throw lines.ended("the cameras' errors");
  for (const KalibrTextCamera& camera : results.cameras) {
    if (!camera.T_cam_imu) throw lines.ended(camera.name + "'s T_ci");
  }
  if (!results.gravity_F) throw lines.ended("the gravity vector");
  if (!results.noise) throw lines.ended(kNoise);
}

}  // namespace

/// mean(|e|^2) = mean^2 + std^2, as the deviation has n in its denominator.
double KalibrErrorStatistics::rms() const { return std::hypot(mean, std); }

double KalibrAxisStatistics::rms() const {
  return std::sqrt(mean.squaredNorm() + std.squaredNorm());
}

std::optional<double> KalibrTextCamera::rmsPx() const {
  if (axis_error_px) return axis_error_px->rms();
  if (error_px) return error_px->rms();
  return std::nullopt;
}

KalibrResults readKalibrResults(const std::string& path) {
  const MappedFile file(path);
  ResultsLines lines(path, file.text());
  KalibrResults results;
  results.path = path;
  if (!lines.next() || !lines.startsWith("Calibration results")) {
    throw lines.fault("this is not a results text of Kalibr",
                      "'Calibration results' in its first line", InputFault::kUnknownFile);
  }
  const bool cameras = file.text().find("Camera-system parameters") != std::string_view::npos;
  results.tool = cameras ? KalibrResults::Tool::kCameras : KalibrResults::Tool::kCameraImu;
  while (lines.next()) {
    cameras ? readCameraToolLine(results, lines) : readImuToolLine(results, lines);
  }
  cameras ? requireCameraTool(results, lines) : requireImuTool(results, lines);
  return results;
}

}  // namespace plumbline
