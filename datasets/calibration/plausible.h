// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "calibrator/base/calibration.h"

namespace plumbline {

/// A value that no rig has: which one, what it is and what it should be.
struct Implausible {
  enum class Part {
    kProjection,
    kDistortion,
    kResolution,
    kName,
    kPlace,
    kOffset,
    kGravity,
    kNoise,
    kDeviation
  };
  Part part = Part::kProjection;
  std::string what;
  std::string expected;
};

/// The first value out of its range; empty where there is none. Ranges: focal lengths above 0 and
/// up to 1e6 px, other parameters up to 1e6; sides of an image 1 to 65535 px (as JPEG's); distances
/// up to 1000 m; names of 1 to 64 letters, digits, `_`, `-`, `.` that do not begin with a dot,
/// since they become names of files; time offsets up to a day, either way; noise, rates and
/// standard deviations 0 or more.
std::optional<Implausible> implausible(const Intrinsics& intrinsics);
std::optional<Implausible> implausible(const CameraCalibration& camera);
std::optional<Implausible> implausible(const ImuNoise& noise);
std::optional<Implausible> implausible(const ImuCalibration& imu);

/// Gravity anywhere on Earth is 9.76 to 9.84 m/s^2; outside 9 to 10.5 a file means something else.
std::optional<Implausible> implausibleGravity(double gravity_m_s2);

/// Throws InputError, naming the file, for the first implausible value of a calibration.
void checkPlausible(const Calibration& calibration, const std::string& path);

/// Whether a text may be a camera's name.
bool isName(const std::string& text);

}  // namespace plumbline
