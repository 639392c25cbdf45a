// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/error.h"
#include "calibrator/base/session.h"
#include "evaluate/calibration/calibrate_session.h"
#include "evaluate/session/load_session.h"
#include "report/records/calibration_record.h"

namespace plumbline {

/// A failure of the camera stage, marked where the lens may be too wide for the model that was
/// tried; with what single cameras tell, where each of several explains its corners alone
/// (camerasApart()) or only another than the one that is named does not.
Failure causeOfCameraFailure(const Failure& failure, const CalibrateRequest& request,
                             const Session& session);

/// A failure of the camera-IMU stage on these cameras, located: that of the cameras where poses of
/// their own do not explain the corners either; of some cameras where only their stamps contradict
/// the gyroscope.
Failure causeOfImuFailure(const Failure& failure, const CalibrateRequest& request,
                          const LoadedSession& loaded,
                          const std::vector<CameraCalibration>& cameras,
                          const CalibrationRecord& record);

}  // namespace plumbline
