// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/session.h"

namespace plumbline::test {

/// The corners that another solver found in euroc_cam_april_images (26 stereo pairs), as a session.
Session otherSolversSession(const std::string& shared_data);

/// The calibration it found from them, in Basalt's format: "ds", "eucm", "kb4" or "pinhole".
std::vector<CameraCalibration> otherSolversCameras(const std::string& shared_data,
                                                   const std::string& model);

}  // namespace plumbline::test
