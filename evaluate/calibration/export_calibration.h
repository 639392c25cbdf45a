// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/image.h"
#include "calibrator/batch/camera/batch.h"
#include "datasets/calibration/export/calibration_export.h"

namespace plumbline {

/// What a camera's lens lost by being given in another model: |projection in the new model - pixel|
/// over an even grid from the image's first pixels to its last, along the rays of the old one.
struct ModelConversion {
  std::string camera;
  std::string from, to;  ///< "pinhole-radtan"
  double rms_px = 0;
  double most_px = 0;
  /// Share of the image that the old model has rays for and the new one does not show, all of it 88
  /// degrees and more off the axis.
  double outside = 0;
  ImageCells cells;
  /// RMS per cell [px]; empty where the old model has no ray, or the new one no pixel for it.
  std::vector<std::optional<double>> region_px;
};

/// Gives every camera of the calibration in another model, with the least projection error over its
/// image (convertedLens()); poses stay, standard deviations of the intrinsics go. Cameras that have
/// the model already stay as they are. Throws InputError, with `path` as the file, where a lens
/// cannot be given in it: where the closest one is off by more than 2 px RMS, or does not show a
/// pixel less than 88 degrees off the axis.
std::vector<ModelConversion> convertModels(Calibration& calibration, const CameraModelPair& model,
                                           const std::string& path);

/// A conversion as lines of text: the error over all, and by region from the top left.
std::string conversionText(const ModelConversion& conversion);

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
/// Noise densities are known where the file states them (CalibrationFile::statesImuNoise()) or
/// `imu` is given, the time offset where it states that (statesTimeOffset()). Throws InputError for
/// what cannot be read or represented.
CalibrationExport exportCalibrationFile(const ExportRequest& request);

}  // namespace plumbline
