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
  std::string out;                       ///< folder, made if missing
  std::optional<std::string> imu;        ///< Kalibr's imu.yaml: its noise replaces the file's
  std::vector<std::string> only;         ///< names of cameras in the order wanted; empty: all
  std::optional<double> camera_rate_hz;  ///< ExportOptions::camera_rate_hz
};

struct ExportOutcome {
  std::vector<std::string> paths;  ///< of the files written
  std::vector<std::string> warnings;
};

/// Reads a calibration and writes it in a tool's format into `out`: all files or none.
///
/// Noise densities are known where the file states them (statesImuNoise()) or `imu` is given. Files
/// of the same names are replaced if an earlier export wrote them; anything else is left alone.
/// Throws InputError for what cannot be read, represented or written, and for a file in the way
/// that is not ours.
ExportOutcome exportCalibrationFile(const ExportRequest& request);

}  // namespace plumbline
