// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrator/base/calibration.h"
#include "datasets/calibration/plausible.h"
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

/// Where a file states the parts of what was read from it.
using KeysOfParts = std::vector<std::pair<Implausible::Part, std::string>>;

/// InputError at the part's key where there is an implausible value.
void refuseImplausible(const YamlMap& map, const std::optional<Implausible>& found,
                       const KeysOfParts& keys);

/// Densities and rate of an IMU by Kalibr's keys, each positive, the rate under `rate_key`.
/// InputError where one is not, or where they are implausible.
ImuNoise noiseFields(const YamlMap& map, const std::string& rate_key);

/// Models, parameters and resolution of one camera, in Kalibr's order (see Intrinsics).
Intrinsics intrinsicsField(const YamlMap& map, const IntrinsicsKeys& keys);

/// InputError where one of our cameras has not as many parameters, and deviations if any, as its
/// models say.
void checkParameterCounts(const YamlMap& map, const Intrinsics& intrinsics);

}  // namespace plumbline
