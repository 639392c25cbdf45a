// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/plausible.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "datasets/files/bad_input.h"

namespace plumbline {
namespace {

using Part = Implausible::Part;

// What a file may hold at all, far beyond any rig, so that figures stay finite. What is unlikely is
// told by lint (evaluate/compare).
constexpr double kMostParameter = 1e6;
// JPEG's sixteen bits.
constexpr int kLongestSide_px = 65535;
constexpr double kFarthest_m = 1000;
constexpr double kLongestOffset_s = 86400;
constexpr double kMostNoise = 1e3;
constexpr double kHighestRate_hz = 1e6;
constexpr std::size_t kLongestName = 64;

/// False for NaN.
bool within(double value, double least, double most) { return value >= least && value <= most; }

std::optional<Implausible> outside(Part part, const std::string& name, double value,
                                   const std::string& expected) {
  return Implausible{part, fmt::format("{} is {:g}", name, value), expected};
}

std::optional<Implausible> implausiblePlace(const Transform& T, const char* name) {
  if (T.t.allFinite() && T.R.allFinite() && T.t.norm() <= kFarthest_m) return std::nullopt;
  return outside(Part::kPlace, std::string("the distance of ") + name, T.t.norm(),
                 fmt::format("at most {:g} m", kFarthest_m));
}

/// Deviations that are not known are NaN.
template <class Values>
std::optional<Implausible> negativeDeviation(const std::optional<Values>& std) {
  if (!std) return std::nullopt;
  for (const double value : *std) {
    if (value < 0) return outside(Part::kDeviation, "a standard deviation", value, "0 or more");
  }
  return std::nullopt;
}

}  // namespace

bool isName(const std::string& text) {
  constexpr std::string_view kOthers = "_-.";
  const auto allowed = [&](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           kOthers.find(c) != std::string_view::npos;
  };
  return !text.empty() && text.size() <= kLongestName && text[0] != '.' &&
         std::all_of(text.begin(), text.end(), allowed);
}

std::optional<Implausible> implausible(const Intrinsics& k) {
  if (!within(k.resolution.width, 1, kLongestSide_px) ||
      !within(k.resolution.height, 1, kLongestSide_px)) {
    return Implausible{
        Part::kResolution,
        fmt::format("the resolution is {}x{}", k.resolution.width, k.resolution.height),
        fmt::format("sides of 1 to {} pixels", kLongestSide_px)};
  }
  const Eigen::Index n = k.projection.size();
  for (Eigen::Index i = 0; i < n; ++i) {
    const bool focal = i == n - 4 || i == n - 3;  // fu, fv, pu, pv are the last
    const double value = k.projection(i);
    if (focal && !(value > 0 && value <= kMostParameter)) {
      return outside(Part::kProjection, "a focal length", value, "pixels, above 0");
    }
    if (!within(value, -kMostParameter, kMostParameter)) {
      return outside(Part::kProjection, "a parameter of the projection", value, "a usual size");
    }
  }
  for (const double value : k.distortion) {
    if (within(value, -kMostParameter, kMostParameter)) continue;
    return outside(Part::kDistortion, "a distortion coefficient", value, "a usual size");
  }
  return std::nullopt;
}

std::optional<Implausible> implausible(const CameraCalibration& camera) {
  if (!isName(camera.name)) {
    return Implausible{Part::kName, fmt::format("a camera is named '{}'", camera.name),
                       "1 to 64 letters, digits, _, - or ., such as cam0"};
  }
  if (const auto place = implausiblePlace(camera.T_C0Ci, "a camera")) return place;
  if (const auto std = negativeDeviation(camera.intrinsics_std)) return std;
  if (const auto std = negativeDeviation(camera.T_C0Ci_std)) return std;
  return implausible(camera.intrinsics);
}

std::optional<Implausible> implausible(const ImuNoise& noise) {
  for (const double density :
       {noise.gyro_density, noise.gyro_random_walk, noise.accel_density, noise.accel_random_walk}) {
    if (within(density, 0, kMostNoise)) continue;
    return outside(Part::kNoise, "a noise density of the IMU", density, "0 or more, in SI units");
  }
  if (within(noise.rate_hz, 0, kHighestRate_hz)) return std::nullopt;  // 0: not known
  return outside(Part::kNoise, "the IMU's rate", noise.rate_hz, "Hz, above 0");
}

std::optional<Implausible> implausible(const ImuCalibration& imu) {
  if (const auto place = implausiblePlace(imu.T_SC0, "the IMU")) return place;
  if (const auto std = negativeDeviation(imu.T_SC0_std)) return std;
  if (const double std = imu.time_offset_std_s.value_or(0); std < 0) {
    return outside(Part::kDeviation, "the time offset's standard deviation", std, "0 or more");
  }
  for (const TimeOffset& offset : imu.time_offsets) {
    if (within(offset.s, -kLongestOffset_s, kLongestOffset_s)) continue;
    return outside(Part::kOffset, "the time offset", offset.s, "seconds, at most those of a day");
  }
  // Only what would spoil the figures; implausibleGravity() has the narrower bounds.
  if (!(imu.gravity_m_s2 > 0 && imu.gravity_m_s2 < 1e3)) {
    return outside(Part::kGravity, "gravity", imu.gravity_m_s2, "m/s^2, near 9.8");
  }
  return implausible(imu.noise);
}

std::optional<Implausible> implausibleGravity(double gravity_m_s2) {
  if (within(gravity_m_s2, 9, 10.5)) return std::nullopt;
  return outside(Part::kGravity, "gravity", gravity_m_s2, "9 to 10.5 m/s^2");
}

void checkPlausible(const Calibration& calibration, const std::string& path) {
  const auto refuse = [&](const std::optional<Implausible>& found) {
    if (!found) return;
    throw badInput(path, 0,
                   {InputFault::kOutOfRange, found->what, found->expected, "correct the file"});
  };
  for (const CameraCalibration& camera : calibration.cameras) refuse(implausible(camera));
  if (calibration.imu) refuse(implausible(*calibration.imu));
}

}  // namespace plumbline
