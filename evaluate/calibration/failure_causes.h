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

/// Marks the failure of a camera stage whose lens may be too wide for the model that was tried.
Failure withModelSuspect(Failure failure, const CalibrateRequest& request, const Session& session);

/// A failure of the camera-IMU stage on these cameras, located: that of the cameras where poses of
/// their own do not explain the corners either; of some cameras where only their stamps contradict
/// the gyroscope.
Failure causeOfImuFailure(const Failure& failure, const CalibrateRequest& request,
                          const LoadedSession& loaded,
                          const std::vector<CameraCalibration>& cameras,
                          const CalibrationRecord& record);

}  // namespace plumbline
