// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibrator/base/calibration.h"

namespace plumbline {

/// Reads a calibration, ours (calibration.json) or Kalibr's (camchain*.yaml), told by its content.
///
/// Kalibr: T_cam_imu maps IMU to camera, T_cn_cnm1 the previous camera to this one; a chain is
/// resolved to T_C0Ci. The IMU is there if cam0 has T_cam_imu; the time offset is the mean of the
/// cameras' timeshift_cam_imu. Its noise is not in that file.
/// Throws InputError, with file and line, for a file that is neither, missing keys, transforms that
/// are not rigid or contradict each other by more than 1 mm or 0.1 degrees, a rolling shutter
/// (line_delay), and models whose number of parameters is wrong.
Calibration readCalibration(const std::string& path);

}  // namespace plumbline
