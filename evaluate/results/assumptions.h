// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibrator/base/session.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "report/records/calibration_record.h"

namespace plumbline {

/// What estimates under these options rest on: noise of the corners and loss as `camera` has them,
/// gravity as `camera_imu` has it; no IMU noise.
Assumptions assumptionsOf(const CameraStageOptions& camera, const CameraImuOptions& camera_imu);

/// The same with the noise densities of the session's IMU, if it has one.
Assumptions assumptionsOf(const CameraStageOptions& camera, const CameraImuOptions& camera_imu,
                          const Session& session);

}  // namespace plumbline
