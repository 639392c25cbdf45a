// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/calibration.h"
#include "datasets/calibration/calibration_reader.h"
#include "evaluate/lint/rules.h"

namespace plumbline::lint {
namespace {

double longestBaseline(const Calibration& calibration) {
  double longest = 0;
  for (const CameraCalibration& camera : calibration.cameras) {
    longest = std::max(longest, camera.T_C0Ci.t.norm());
  }
  return longest;
}

// "/d435i" of "/d435i/infra1/image_raw".
std::string deviceOf(const std::string& topic) {
  const std::size_t start = topic.rfind('/', 0) == 0 ? 1 : 0;
  const std::size_t end = topic.find('/', start);
  return end == std::string::npos ? std::string() : topic.substr(start, end - start);
}

bool isOneDevice(const Calibration& calibration) {
  const std::string device = deviceOf(calibration.imu->rostopic);
  return !device.empty() && device == deviceOf(calibration.cameras.front().rostopic);
}

// ---- translations

std::vector<Finding> translationUnits(const LintedCalibration& linted) {
  std::vector<Finding> found;
  const auto check = [&](const std::string& field, const Transform& T) {
    const double length = T.t.norm();
    if (!(length > kMaxBaseline_m)) return;
    found.push_back(
        bad("Millimetres for metres",
            fmt::format("{}: the translation of {} is {:.4g} m long; in millimetres it would be "
                        "{:.4g} m",
                        linted.name, field, length, 1e-3 * length),
            fmt::format("divide the translation of {} in {} by 1000", field, linted.name),
            {length, kMaxBaseline_m, "m"}));
  };
  for (const CameraCalibration& camera : linted.calibration.cameras) {
    check("T_C0Ci (T_cn_cnm1) of " + camera.name, camera.T_C0Ci);
  }
  if (linted.calibration.imu) check("T_SC0 (T_cam_imu)", linted.calibration.imu->T_SC0);
  return found;
}

std::vector<Finding> leverArm(const LintedCalibration& linted) {
  const Calibration& c = linted.calibration;
  if (!c.imu || c.cameras.empty()) return {};
  // Within one housing the longest baseline says how large it is, and the IMU cannot be far
  // outside.
  const bool device = isOneDevice(c);
  const double bound =
      device ? std::max(kDeviceLeverArm_m, kDeviceBaselines * longestBaseline(c)) : kMaxLeverArm_m;
  const double arm = c.imu->T_SC0.t.norm();
  if (arm <= bound) return {};
  return {bad("Impossible lever arm",
              fmt::format("{}: the IMU is {:.1f} cm from camera 0{}", linted.name, 100 * arm,
                          device ? ", of the same device (/" + deviceOf(c.imu->rostopic) + ")"
                                 : std::string()),
              fmt::format("do not use T_cam_imu of {}, even if its residuals are small: "
                          "recalibrate with rotation about all axes",
                          linted.name),
              {arm, bound, "m"})};
}

// ---- intrinsics

// Of how much larger an image the principal point is the centre, along both axes alike; 1: of none.
double impliedScale(const Intrinsics& k) {
  const Eigen::Index n = k.projection.size();
  // The principal point lies in the middle of an image 2 c / size times as large as the one stated.
  const double x = 2 * k.projection(n - 2) / (k.resolution.width - 1);
  const double y = 2 * k.projection(n - 1) / (k.resolution.height - 1);
  const double mean = 0.5 * (x + y);
  return std::abs(x - y) < 0.25 * mean ? mean : 1;
}

/// Distance of the principal point from an image's middle, the larger of its shares of the sides.
double principalShift(const Intrinsics& k, const Resolution& image) {
  const Eigen::Index n = k.projection.size();
  return std::max(std::abs(k.projection(n - 2) / (image.width - 1) - 0.5),
                  std::abs(k.projection(n - 1) / (image.height - 1) - 0.5));
}

/// Uncropped images have it near their middle; another resolution moves it off by its factor.
std::vector<Finding> principalPoint(const LintedCalibration& linted,
                                    const CameraCalibration& camera) {
  const Intrinsics& k = camera.intrinsics;
  const Eigen::Index n = k.projection.size();
  const double shift = principalShift(k, k.resolution);
  if (shift <= kMaxPrincipalShift) return {};
  const double scale = impliedScale(k);
  const bool exchanged =
      principalShift(k, {k.resolution.height, k.resolution.width}) <= kMaxPrincipalShift;
  std::string fits;
  if (exchanged) {
    fits = fmt::format("; it fits {}x{}", k.resolution.height, k.resolution.width);
  } else if (scale != 1) {
    fits = fmt::format("; it fits an image {:.2g} times as large", scale);
  }
  return {bad(
      "Resolution and principal point",
      fmt::format("{}: {}'s principal point ({:.1f}, {:.1f}) is {:.0f} % off the centre of {}x{}{}",
                  linted.name, camera.name, k.projection(n - 2), k.projection(n - 1), 100 * shift,
                  k.resolution.width, k.resolution.height, fits),
      fmt::format("check resolution and intrinsics of {} in {}: {}", camera.name, linted.name,
                  exchanged ? "width and height are likely exchanged"
                            : "one of them belongs to scaled or cropped images"),
      {shift, kMaxPrincipalShift, "share"})};
}

// ---- IMU

std::vector<Finding> offsetUnit(const LintedCalibration& linted) {
  const double offset = meanTimeOffset(*linted.calibration.imu);
  if (std::abs(offset) <= kMaxOffset_s) return {};
  return {bad("Milliseconds for seconds",
              fmt::format("{}: the time offset is {:.4g} s; in milliseconds it would be {:.4g} s",
                          linted.name, offset, 1e-3 * offset),
              fmt::format("divide timeshift_cam_imu (time_offset_s) in {} by 1000", linted.name),
              {std::abs(offset), kMaxOffset_s, "s"})};
}

/// Above its bound a density is in another unit, or a discrete-time deviation: one finding of a
/// file, of the gyroscope first.
std::vector<Finding> noiseSize(const LintedCalibration& linted) {
  if (!linted.noise_known) return {};
  const ImuNoise& noise = linted.calibration.imu->noise;
  const auto finding = [&](const char* sensor, double value, double bound, const char* unit) {
    return bad("Noise densities",
               fmt::format("{}: {}_noise_density is {:.3g} {}", linted.name, sensor, value, unit),
               fmt::format("state {}_noise_density in {} as a continuous-time density in SI units, "
                           "from the data sheet or an Allan deviation",
                           sensor, linted.name),
               {value, bound, unit});
  };
  if (noise.gyro_density > kMaxGyroDensity) {
    return {finding("gyroscope", noise.gyro_density, kMaxGyroDensity, "rad/s/sqrt(Hz)")};
  }
  if (noise.accel_density > kMaxAccelDensity) {
    return {finding("accelerometer", noise.accel_density, kMaxAccelDensity, "m/s^2/sqrt(Hz)")};
  }
  return {};
}

}  // namespace

std::vector<Finding> alone(const LintedCalibration& linted) {
  std::vector<Finding> found = translationUnits(linted);
  // A lever arm in millimetres is impossible, too; its unit is the cause.
  if (found.empty()) append(found, leverArm(linted));
  for (const CameraCalibration& camera : linted.calibration.cameras) {
    append(found, principalPoint(linted, camera));
  }
  if (!linted.calibration.imu) return found;
  append(found, offsetUnit(linted));
  append(found, noiseSize(linted));
  return found;
}

}  // namespace plumbline::lint

namespace plumbline {

LintedCalibration lintedFrom(const CalibrationFile& file, Calibration calibration) {
  const bool noise_known = calibration.imu && file.statesImuNoise();
  return {std::filesystem::path(file.path()).filename().string(), std::move(calibration),
          noise_known, file.statesTimeOffset(), file.statesImuPlacesTwice()};
}

}  // namespace plumbline
