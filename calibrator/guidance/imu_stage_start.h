// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibrator/base/error.h"
#include "calibrator/guidance/imu_stage_recording.h"
#include "calibrator/window/camera_imu_window.h"

namespace plumbline {

/// The window on the first frames of the camera-IMU stage: their batch (the time offset by
/// correlation and refined in it, then held), of which all but the last frames become the window's
/// prior. Frames at the end that IMU samples do not cover yet are left out. Fails where
/// calibrateCameraImu() does or where it did not converge.
Result<CameraImuWindow> startImuWindow(const ImuStageRecording& recording,
                                       const std::vector<CameraCalibration>& cameras,
                                       const TrajectoryGuideOptions& options);

}  // namespace plumbline
