// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "calibrator/base/transform.h"
#include "calibrator/initialise/imu_alignment.h"
#include "evaluate/compare/lint/rules.h"

namespace plumbline {
namespace {

constexpr double kFollows = 0.9;       // correlation of rates that are copies of each other
constexpr double kSameFrameRad = 0.3;  // up to which the trajectory's body counts as the IMU

using Q = Eigen::Quaterniond;

// A cyclic shift of four components is a reflection of their space: it equals the conjugate but for
// a constant turn of world and of body. Rates therefore tell that something is reversed; which of
// these it is, only a body with the IMU's axes tells.
struct Reading {
  const char* name;
  Q (*read)(const Q& q);
};

constexpr Reading kReversals[] = {
    {"with w first in place of last", [](const Q& q) { return Q(q.x(), q.y(), q.z(), q.w()); }},
    {"with w last in place of first", [](const Q& q) { return Q(q.z(), q.w(), q.x(), q.y()); }},
    {"as conjugates", [](const Q& q) { return q.conjugate(); }},
};

RateAlignment alignmentOf(const Trajectory& trajectory, const GyroIntegral& gyro,
                          Q (*read)(const Q&)) {
  std::vector<CameraPose> poses;
  for (const StampedPose& pose : trajectory.poses) {
    poses.push_back({pose.t, Transform(read(pose.q), pose.p)});
  }
  const auto estimate = estimateTimeOffset(cameraRates(poses, lint::longestGap(poses)), gyro);
  return estimate ? estimate->alignment : RateAlignment();
}

// The reading under which the body's axes are the IMU's; nothing where none is.
const Reading* likeliest(const Trajectory& trajectory, const GyroIntegral& gyro) {
  for (const Reading& reading : kReversals) {
    const RateAlignment alignment = alignmentOf(trajectory, gyro, reading.read);
    const bool follows = alignment.correlation >= kFollows;
    if (follows && rotationAngle(alignment.R_SC0) < kSameFrameRad) return &reading;
  }
  return nullptr;
}

}  // namespace

std::vector<Finding> lintQuaternionOrder(const Trajectory& trajectory, const std::string& name,
                                         std::span<const ImuSample> samples) {
  const GyroIntegral gyro(samples);
  const auto correlation = [&](Q (*read)(const Q&)) {
    return alignmentOf(trajectory, gyro, read).correlation;
  };
  const double as_read = correlation([](const Q& q) { return q; });
  const double reversed = correlation([](const Q& q) { return q.conjugate(); });
  if (as_read >= kFollows || reversed < kFollows) return {};
  const Reading* const reading = likeliest(trajectory, gyro);
  return {lint::bad(
      "Order of quaternions",
      fmt::format("{}: as they stand, its rotations do not follow the gyroscope (correlation "
                  "{:.3f}); reversed they do ({:.3f}){}",
                  name, as_read, reversed,
                  reading == nullptr
                      ? std::string()
                      : fmt::format(", with the IMU's own axes when read {}", reading->name)),
      fmt::format("state the order of the quaternions in the header of {}; if that is right, they "
                  "are conjugates (JPL, or world to body): conjugate them",
                  name),
      {as_read, kFollows, "-"})};
}

}  // namespace plumbline
