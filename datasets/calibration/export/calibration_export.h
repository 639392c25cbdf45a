// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/enum_words.h"

namespace plumbline {

/// Tools in whose own format a calibration can be written.
enum class ExportTool { kKalibr, kOrbSlam3, kOpenVins, kVinsFusion, kOkvis2, kBasalt, kCameraInfo };
constexpr std::array<const char*, 7> enumWords(ExportTool /*of*/) {
  return {"kalibr", "orbslam3", "openvins", "vins-fusion", "okvis2", "basalt", "camera_info"};
}
/// All of them, in the order of the enumeration.
std::vector<ExportTool> exportTools();

/// What the files say besides the calibration.
struct ExportOptions {
  std::string source;   ///< path of the calibration: in full in errors, its file name in comments
  std::string version;  ///< of Plumbline, for the line of provenance
  bool noise_known = true;               ///< false: the IMU's noise densities are not measured
  std::optional<double> camera_rate_hz;  ///< ORB-SLAM3 wants one; 20 with a warning where empty
  bool offset_known = true;              ///< false: the source states no time offset

  /// Throws InputError for a value out of its range.
  void check() const;
};

struct ExportFile {
  std::string name;  ///< without folder
  std::string text;
};

/// The files of one tool, and what the user must know beside them (also in the files' comments).
struct ExportedFiles {
  std::vector<ExportFile> files;
  std::vector<std::string> warnings;
};

/// The line that every exported text starts its comments with: by it a file is known as ours.
inline constexpr const char* kExportMark = "Written by Plumbline";

/// Writes a calibration in a tool's own format, converting directions of transforms, the sign of
/// the time offset (ours: t_imu = t_cam + t_d), units of noise and names of models. Numbers read
/// back to the same doubles, except where the format itself holds less: ORB-SLAM3 reads floats,
/// Basalt whole nanoseconds of time offset. docs/export.md has the table of all tools.
///
/// Throws InputError, naming `options.source`, the tool and the cure, for what the tool cannot
/// hold: a projection model, too many cameras, cameras of different size or model where it wants
/// one, no IMU where it needs one, unknown noise where it needs that.
ExportedFiles exportCalibration(const Calibration& calibration, ExportTool tool,
                                const ExportOptions& options);

/// The calibration of the cameras named, in that order, with the first as the new camera 0:
/// T_C0Ci, T_SC0 and the time offset are moved to it. Standard deviations of what moves are
/// dropped, since their correlations are not known here. All cameras for an empty list. Throws
/// InputError (for `path`) for a name that is not there, or is there twice.
Calibration selectCameras(const Calibration& calibration, const std::vector<std::string>& names,
                          const std::string& path);

/// The same of cameras by their places, each at most once.
Calibration selectCameras(const Calibration& calibration, const std::vector<std::size_t>& places);

}  // namespace plumbline
