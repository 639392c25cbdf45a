// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/error.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "report/records/calibration_record.h"

namespace plumbline {

/// The camera-IMU stage on these cameras; a failure where it did not converge, for
/// calibrateCameraImu() returns where it stopped. Where `estimated` is the stage that the cameras
/// are from, the robust deviations of T_SC0 and the time offset hold what it leaves open
/// (robustDeviationsOfBothStages()): the batch alone takes the cameras as exact.
Result<CameraImuStageResult> convergedCameraImu(const Session& session,
                                                const std::vector<CameraCalibration>& cameras,
                                                const CameraImuOptions& options,
                                                const CameraStageResult* estimated = nullptr);

/// The deviations of a record's parameters, as its calibration.json states them to
/// CalibrationFile::deviations(): robust where they are known, else formal.
StatedDeviations statedDeviations(const CalibrationRecord& record);

}  // namespace plumbline
