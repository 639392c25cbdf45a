// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
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

/// The key's [width, height]; InputError where they are not two positive numbers.
Resolution resolutionField(const YamlMap& map, const std::string& key);

/// How a file calls the parts of a camera's intrinsics.
struct IntrinsicsKeys {
  const char* projection_model;
  const char* distortion_model;
  const char* projection = "intrinsics";
  const char* distortion = "distortion_coeffs";
};

/// Models, parameters and resolution of one camera, in Kalibr's order (see Intrinsics).
Intrinsics intrinsicsField(const YamlMap& map, const IntrinsicsKeys& keys);

/// InputError where one of our cameras has not as many parameters, and deviations if any, as its
/// models say.
void checkParameterCounts(const YamlMap& map, const Intrinsics& intrinsics);

}  // namespace plumbline
