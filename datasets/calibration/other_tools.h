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

/// Whether the file is a result of yac (github.com/chutsu/yac): its cameras have `proj_model`.
bool isYacResult(const YamlMap& file);

/// Cameras camN with proj_model, dist_model ("radtan4", "equi4"), proj_params, dist_params and
/// T_cam0_camN = T_C0CN (OpenCV matrices). With an imu0 section: T_imu0_cam0 = T_SC0, time_delay
/// [s] = our time offset, g [m/s^2], and sigma_g_c, sigma_gw_c, sigma_a_c, sigma_aw_c as
/// continuous-time densities.
/// Not read: ba and bg, whose labels are swapped in what yac writes (what it calls ba is the
/// gyroscope's bias and the reverse), and the poses.
Calibration readYacResult(const YamlMap& file);

}  // namespace plumbline
