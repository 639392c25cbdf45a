// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "datasets/calibration/export/calibration_export.h"
#include "evaluate/calibration/convert_models.h"

namespace plumbline {

struct ExportRequest {
  std::string calibration;  ///< file that readCalibration() knows
  ExportTool tool = ExportTool::kKalibr;
  std::optional<std::string> imu;        ///< Kalibr's imu.yaml: its noise replaces the file's
  std::vector<std::string> only;         ///< names of cameras in the order wanted; empty: all
  std::optional<double> camera_rate_hz;  ///< ExportOptions::camera_rate_hz
  std::optional<CameraModelPair> model;  ///< give the cameras in this one
};

/// The files, and what the lenses lost where they were given in another model.
struct CalibrationExport : ExportedFiles {
  std::vector<ModelConversion> conversions;
};

/// Reads a calibration and gives it in a tool's format: the files, and what they leave out.
///
/// Noise densities are known where the file states them (statesImuNoise()) or `imu` is given.
/// Throws InputError for what cannot be read or represented.
CalibrationExport exportCalibrationFile(const ExportRequest& request);

}  // namespace plumbline
