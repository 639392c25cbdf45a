// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/session.h"

namespace plumbline::test {

/// The recording euroc_imu_april with the calibration that was published with it. A reader for this
/// folder alone: `calibrator` and its tests stand below the project's readers.
struct EurocRecording {
  Session session;
  std::vector<CameraCalibration> published;  ///< cameras of kalibr/camchain-imucam.yaml
};

/// Reads it from PLUMBLINE_SHARED_DATA; throws std::runtime_error that names the option where a
/// file is missing.
EurocRecording readEurocRecording(const std::string& shared_data);

}  // namespace plumbline::test
