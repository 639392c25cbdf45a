// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrator/base/calibration.h"
#include "datasets/files/yaml_map.h"

namespace plumbline {

inline constexpr const char* kMatrixRows = "four rows of four numbers: a homogeneous transform";

/// The key's 4x4 matrix, as rows or as an OpenCV matrix (rows, cols, data). InputError where it is
/// not rigid to 1e-3.
Transform transformField(const YamlMap& map, const std::string& key);

/// The key's `count` numbers; none where the key is missing and count is 0. InputError for another
/// number of them.
Eigen::VectorXd parametersField(const YamlMap& map, const std::string& key, std::size_t count);

/// The key's [width, height]; InputError where they are not two whole numbers of 1 to 65535.
Resolution resolutionField(const YamlMap& map, const std::string& key);

/// The same of numbers that stand elsewhere below the key.
Resolution resolutionOf(const YamlMap& map, const std::string& key,
                        const std::vector<double>& size);

/// How a file calls the parts of a camera's intrinsics.
struct IntrinsicsKeys {
  const char* projection_model;
  const char* distortion_model;
  const char* projection = "intrinsics";
  const char* distortion = "distortion_coeffs";
};

/// Densities and rate of an IMU by Kalibr's keys, each positive, the rate under `rate_key`.
/// InputError where one is not, or where they are implausible.
ImuNoise noiseFields(const YamlMap& map, const std::string& rate_key);

/// Models, parameters and resolution of one camera, in Kalibr's order (see Intrinsics).
Intrinsics intrinsicsField(const YamlMap& map, const IntrinsicsKeys& keys);

/// InputError where one of our cameras has not as many parameters, and deviations if any, as its
/// models say.
void checkParameterCounts(const YamlMap& map, const Intrinsics& intrinsics);

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

  Complaint complaint(const std::string& cure) const {
    return {InputFault::kOutOfRange, what, expected, cure};
  }
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

/// InputError, naming the file, for the first implausible value of a calibration.
void checkPlausible(const Calibration& calibration, const std::string& path);

/// Where a file states the parts of what was read from it.
using KeysOfParts = std::vector<std::pair<Implausible::Part, std::string>>;

/// InputError at the part's key where there is an implausible value.
void refuseImplausible(const YamlMap& map, const std::optional<Implausible>& found,
                       const KeysOfParts& keys);

}  // namespace plumbline
