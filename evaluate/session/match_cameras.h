// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/session.h"

namespace plumbline {

/// The calibration's cameras in the order of the session's, matched by name, with the session's
/// first camera as camera 0. Throws InputError in the name of `path`, which they were read from,
/// where a camera is missing, has another resolution, or states another camera's topic.
std::vector<CameraCalibration> matchCameras(const Calibration& given, const std::string& path,
                                            const Session& session);

/// The same with the IMU's part, if there is one: T_SC0 of the session's first camera, and the time
/// offsets in the session's order.
Calibration matchCalibration(const Calibration& given, const std::string& path,
                             const Session& session);

/// Throws InputError where one of them has a model that cannot be calibrated.
void refuseUnsupportedModels(const std::vector<CameraCalibration>& cameras,
                             const std::string& path);

}  // namespace plumbline
