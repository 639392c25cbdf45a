// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibrator/base/calibration.h"
#include "datasets/files/yaml_map.h"

namespace plumbline {

/// Whether the file is Basalt's calibration.json: everything below `value0`.
bool isBasaltCalibration(const YamlMap& file);

/// T_imu_cam[i] (px py pz, Hamilton qx qy qz qw) = T_SCi; cam_time_offset_ns = our time offset;
/// noise as continuous-time densities of the first axis. Camera types pinhole, pinhole-radtan8 with
/// k3 to k6 zero, kb4 (equidistant), ds, eucm, and ucm as Kalibr's omni (xi = alpha / (1 - alpha),
/// focal lengths times 1 + xi). Scale, misalignment and biases of the IMU are not read. InputError
/// for other types and quaternions that are not of unit length to 1e-3.
Calibration readBasaltCalibration(const YamlMap& file);

}  // namespace plumbline
