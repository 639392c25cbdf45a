// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/calibration/export_calibration.h"

#include "calibrator/base/error.h"
#include "datasets/calibration/calibration_reader.h"
#include "datasets/calibration/export/calibration_export.h"
#include "datasets/session/streams.h"
#include "generated/version.h"

namespace plumbline {
namespace {

Calibration requestedCalibration(const ExportRequest& request) {
  Calibration calibration =
      selectCameras(readCalibration(request.calibration), request.only, request.calibration);
  if (!request.imu) return calibration;
  if (!calibration.imu) {
    throw InputError(request.calibration, 0,
                     "has no IMU whose noise could be replaced; calibrate with an IMU");
  }
  const ImuDescription imu = readImuDescription(*request.imu);
  calibration.imu->noise = imu.noise;
  // A noise file that names no topic does not take the calibration's.
  if (!imu.rostopic.empty()) calibration.imu->rostopic = imu.rostopic;
  return calibration;
}

}  // namespace

CalibrationExport exportCalibrationFile(const ExportRequest& request) {
  const ExportOptions options{request.calibration, kVersion,
                              request.imu.has_value() || statesImuNoise(request.calibration),
                              request.camera_rate_hz, statesTimeOffset(request.calibration)};
  Calibration calibration = requestedCalibration(request);
  CalibrationExport out;
  if (request.model) {
    out.conversions = convertModels(calibration, *request.model, request.calibration);
  }
  // The files alone; what the conversion lost stands in `out` already.
  static_cast<ExportedFiles&>(out) = exportCalibration(calibration, request.tool, options);
  return out;
}

}  // namespace plumbline
