// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibrator/base/error.h"
#include "calibrator/base/results.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/batch/resample.h"

namespace plumbline {

/// Solves the camera-IMU batch again on every draw of a bootstrap over time segments, each started
/// from `earlier` under the options that gave it. Draws are shared out over resample.threads; the
/// result does not depend on their number. Rows as in the covariance of `earlier` (tangent of
/// T_SC0, time offset, freed cameras). Fails with kTooFewViews if fewer than two draws have a
/// solution.
Result<ResampleSummary> resampleCameraImu(const Session& session,
                                          const CameraImuStageResult& earlier,
                                          const ResampleOptions& resample,
                                          const CameraImuOptions& options = {});

}  // namespace plumbline
