// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "datasets/calibration/export/calibration_export.h"

namespace plumbline {

struct ExportRequest {
  std::string calibration;  ///< file that readCalibration() knows
  ExportTool tool = ExportTool::kKalibr;
  std::optional<std::string> imu;        ///< Kalibr's imu.yaml: its noise replaces the file's
  std::vector<std::string> only;         ///< names of cameras in the order wanted; empty: all
  std::optional<double> camera_rate_hz;  ///< ExportOptions::camera_rate_hz
};

/// Reads a calibration and gives it in a tool's format: the files, and what they leave out.
///
/// Noise densities are known where the file states them (statesImuNoise()) or `imu` is given.
/// Throws InputError for what cannot be read or represented.
ExportedFiles exportCalibrationFile(const ExportRequest& request);

}  // namespace plumbline
