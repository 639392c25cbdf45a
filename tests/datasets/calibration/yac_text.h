// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace plumbline::test {

/// A result of yac: cameras of two lens models, its IMU and time delay.
inline constexpr const char* kYacResult = R"(imu0:
  rate: 200.0
  sigma_a_c: 2.0e-03
  sigma_g_c: 1.7e-04
  sigma_aw_c: 3.0e-03
  sigma_gw_c: 2.0e-05
  g: 9.81
  ba: [-0.002198, 0.024434, 0.076713]
time_delay: 0.0015  # imu_timestamp = camera_timestamp + time_delay
cam0:
  resolution: [752, 480]
  proj_model: "pinhole"
  dist_model: "radtan4"
  proj_params: [458.0, 457.0, 367.0, 248.0]
  dist_params: [-0.28, 0.07, 0.0002, 1.0e-05]
cam1:
  resolution: [752, 480]
  proj_model: "pinhole"
  dist_model: "equi4"
  proj_params: [458.0, 457.0, 367.0, 248.0]
  dist_params: [-0.28, 0.07, 0.0002, 1.0e-05]
T_cam0_cam1:
  rows: 4
  cols: 4
  data: [1, 0, 0, 0.11,  0, 1, 0, 0,  0, 0, 1, 0,  0, 0, 0, 1]
T_imu0_cam0:
  rows: 4
  cols: 4
  data: [0, -1, 0, -0.02,  1, 0, 0, -0.06,  0, 0, 1, 0.01,  0, 0, 0, 1]
)";

}  // namespace plumbline::test
