// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/session.h"
#include "calibrator/base/transform.h"

namespace plumbline {

/// One IMU of Kalibr's imu.yaml, whatever its model: for comparing. What a calibration starts from
/// is read by readImuDescription(), which refuses models with scale and misalignment.
struct KalibrImu {
  std::string name = "imu0";
  std::string rostopic;
  std::string model = "calibrated";  ///< or "scale-misalignment", "scale-misalignment-size-effect"
  ImuNoise noise;                    ///< continuous-time densities
  Transform T_i_b;                   ///< body (the first IMU) into this IMU
  double time_offset_s = 0;          ///< with respect to the first IMU
  /// measured = M true + bias (accelerometer), M and g-sensitivity A [(rad/s)/(m/s^2)] of the gyro,
  /// and its frame C_gyro_i; missing for a calibrated IMU.
  std::optional<Eigen::Matrix3d> accel_M;
  std::optional<Eigen::Matrix3d> gyro_M;
  std::optional<Eigen::Matrix3d> gyro_A;
  std::optional<Eigen::Matrix3d> C_gyro_i;
};

struct KalibrImuFile {
  std::string path;
  bool wrapped = false;  ///< below imu0:, as Kalibr writes its results; false: flat, as its input
  std::vector<KalibrImu> imus;
};

/// Reads imu.yaml, flat or wrapped. Throws InputError, with file and line, for missing keys and
/// densities that are not positive.
KalibrImuFile readKalibrImus(const std::string& path);

}  // namespace plumbline
