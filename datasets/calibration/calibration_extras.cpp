// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/calibration_extras.h"

#include <algorithm>

#include <fmt/format.h>

#include "datasets/calibration/other_tools.h"
#include "datasets/files/yaml_map.h"

namespace plumbline {
namespace {

ParameterCovariance covarianceOf(const YamlMap& map) {
  ParameterCovariance out;
  for (const YamlMap& parameter : map.maps("parameters", "a list of names and units")) {
    out.names.push_back(parameter.text("name", "a parameter's name"));
    out.units.push_back(parameter.text("unit", "its unit"));
  }
  const auto rows = map.rows("matrix", "rows of numbers");
  const std::size_t n = out.names.size();
  const bool square = rows.size() == n && std::all_of(rows.begin(), rows.end(),
                                                      [n](const auto& r) { return r.size() == n; });
  if (!square) {
    throw map.fault("matrix",
                    {InputFault::kContradiction, "the covariance does not fit its parameters",
                     fmt::format("{} rows of {} numbers", n, n), "copy the file again"});
  }
  out.matrix.resize(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      out.matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = rows[i][j];
    }
  }
  return out;
}

// The camera-IMU stage's where it estimated the cameras too, otherwise the camera stage's.
std::optional<ParameterCovariance> camerasCovariance(const YamlMap& file) {
  if (!file.has("covariance")) return std::nullopt;
  const YamlMap stages = file.map("covariance", "the stages' covariances");
  for (const char* stage : {"camera_imu", "camera"}) {
    if (!stages.has(stage)) continue;
    ParameterCovariance covariance = covarianceOf(stages.map(stage, "a covariance"));
    const auto is_focal = [](const std::string& name) { return name.ends_with(".fu"); };
    if (std::any_of(covariance.names.begin(), covariance.names.end(), is_focal)) return covariance;
  }
  return std::nullopt;
}

}  // namespace

CalibrationExtras readCalibrationExtras(const std::string& path) {
  const YamlMap file = YamlMap::load(path, "a calibration");
  CalibrationExtras extras;
  if (isYacResult(file)) {
    extras.tool = "yac";
  } else if (file.has("cam0")) {
    const YamlMap camera = file.map("cam0", "a camera");
    extras.tool = camera.has("T_imu_cam") ? "openvins" : "kalibr";
  } else if (isBasaltCalibration(file)) {
    extras.tool = "basalt";
  } else {
    extras.tool = "plumbline";
    extras.cameras = camerasCovariance(file);
    if (file.has("provenance")) {
      const YamlMap provenance = file.map("provenance", "where the result comes from");
      extras.input = provenance.textOr("input", "");
      extras.input_hash = provenance.textOr("input_hash", "");
    }
  }
  return extras;
}

}  // namespace plumbline
