// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "evaluate/metrics/verdict.h"
#include "evaluate/results/progress.h"
#include "evaluate/results/result_folder.h"
#include "evaluate/session/load_session.h"
#include "report/records/calibration_record.h"

namespace plumbline {

/// What `plumbline calibrate` is asked to do.
struct CalibrateRequest {
  LoadRequest load;
  CameraStageOptions camera;
  CameraImuOptions camera_imu;
  /// Kalibr's or our file: its intrinsics and camera extrinsics are used as they are.
  std::optional<std::string> cameras_file;
  bool free_cameras = false;  ///< cameras_file is only the start of the camera stage
  bool use_imu = true;
  bool halves = true;  ///< solve the recording's halves apart and say whether they agree
  int resamples = 0;   ///< bootstrap solutions over resampled time segments; 0: none
  std::uint64_t seed = 1;
  VerdictThresholds thresholds;
  Provenance provenance;  ///< version, command, options and date; input and hash are filled in

  /// Throws InputError for values out of range.
  void check() const;
};

/// Loads, detects, calibrates the cameras and the camera-IMU, resamples, and judges: everything but
/// writing. The record holds all that the report shows.
/// Throws InputError for bad input; a Failure says what the data cannot give.
Result<CalibrationRecord> calibrateSession(const CalibrateRequest& request,
                                           const ProgressSink& progress);

/// The documents of a calibration: calibration.json, camchain-imucam.yaml (camchain.yaml without
/// IMU), imu.yaml, and residuals.csv if `residuals`.
std::vector<ResultFile> calibrationFiles(const CalibrationRecord& record, bool residuals);

/// What a person wants to see on the terminal after a calibration: the parameters with their
/// standard deviations, the errors, and the verdict with every finding that is not good.
std::string calibrationSummary(const CalibrationRecord& record);

/// Keeps the images of the views with the largest errors (kWorstViews, of the camera stage, or of
/// the camera-IMU stage where the cameras were given) in the record: grey, made smaller by a whole
/// factor to at most 800 pixels of width, of JPEG quality 60. Views of a camera that comes as
/// corners have none, nor those whose image cannot be read any more: the result stands without.
void addViewImages(const LoadedSession& loaded, CalibrationRecord& record);

}  // namespace plumbline
