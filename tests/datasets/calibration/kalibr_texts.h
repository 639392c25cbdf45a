// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "calibrator/base/error.h"

// Small outputs of Kalibr, in its own words, with round numbers.
namespace plumbline {

inline const char* const kCamText = R"(Calibration results
====================
Camera-system parameters:
	cam0 (/left):
	 type: <class 'DoubleSphereCameraGeometry'>
	 distortion: [] +- []
	 projection: [  -0.25  0.5  300.  301.
   320. 240.] +- [0.01 0.02 0.1 0.2 0.3
 0.4]
	 reprojection error: [0.3, -0.4] +- [1.2, 0.0]

	cam1 (/right):
	 type: <class 'DistortedPinholeCameraGeometry'>
	 distortion: [-0.1  0.2  0.  0.] +- [0.01 0.01 0.01 0.01]
	 projection: [400. 401. 320. 240.] +- [1. 2. 3. 4.]
	 reprojection error: [0.0, 0.0] +- [0.3, 0.4]

	baseline T_1_0:
	 q: [0. 0. -0.70710678 0.70710678] +- [0.1 0.1 0.1]
	 t: [-0.1 0. 0.02] +- [0.1 0.1 0.1]



Target configuration
====================

  Type: aprilgrid
)";

inline const char* const kImuText = R"(Calibration results
===================
Normalized Residuals
----------------------------
Reprojection error (cam0):     mean 0.3, median 0.2, std: 0.4
Gyroscope error (imu0):        mean 3.0, median 2.0, std: 4.0
Accelerometer error (imu0):    mean 0.6, median 0.5, std: 0.8

Residuals
----------------------------
Reprojection error (cam0) [px]:     mean 0.3, median 0.2, std: 0.4
Gyroscope error (imu0) [rad/s]:     mean 0.003, median 0.002, std: 0.004
Accelerometer error (imu0) [m/s^2]: mean 0.06, median 0.05, std: 0.08

Transformation (cam0):
-----------------------
T_ci:  (imu0 to cam0): 
[[ 0.  1.  0.  0.05]
 [-1.  0.  0.  0.06]
 [ 0.  0.  1.  0.07]
 [ 0.  0.  0.  1.  ]]

T_ic:  (cam0 to imu0): 
[[ 0. -1.  0.  0.06]
 [ 1.  0.  0. -0.05]
 [ 0.  0.  1. -0.07]
 [ 0.  0.  0.  1.  ]]

timeshift cam0 to imu0: [s] (t_imu = t_cam + shift)
-0.0125


Gravity vector in target coords: [m/s^2]
[ 0.6 -9.7  0.8]


IMU configuration
=================

IMU0:
----------------------------
  Model: calibrated
  Update rate: 200.0
  Accelerometer:
    Noise density: 0.002
    Noise density (discrete): 0.0282842712475
    Random walk: 0.003
  Gyroscope:
    Noise density: 0.00017
    Noise density (discrete): 0.00240416305603
    Random walk: 2e-05
  T_i_b
    [[ 1.  0.  0.  0.]]
)";

inline const char* const kCamchainImuYaml = R"(cam0:
  T_cam_imu:
  - [0.0, 1.0, 0.0, 0.05]
  - [-1.0, 0.0, 0.0, 0.06]
  - [0.0, 0.0, 1.0, 0.07]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  distortion_coeffs: [0.0, 0.0, 0.0, 0.0]
  distortion_model: radtan
  intrinsics: [400.0, 400.0, 320.0, 240.0]
  resolution: [640, 480]
  rostopic: /left
  timeshift_cam_imu: -0.0125
)";

inline const char* const kImuYaml = R"(imu0:
  accelerometer_noise_density: 0.002
  accelerometer_random_walk: 0.003
  gyroscope_noise_density: 0.00017
  gyroscope_random_walk: 2.0e-05
  model: calibrated
  rostopic: /imu0
  update_rate: 200.0
)";

/// Of poses-cam0.csv.
inline constexpr const char* kPosesHeader =
    "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
    "q_RS_z []\n";

}  // namespace plumbline
