// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/session.h"

namespace plumbline {

/// What an IMU's YAML file says, in Kalibr's words.
struct ImuDescription {
  ImuNoise noise;
  std::string rostopic;  ///< empty if unknown
};

/// Reads Kalibr's imu.yaml (flat, or wrapped in imu0: as Kalibr writes it) or EuRoC's
/// imu0/sensor.yaml (rate_hz in place of update_rate). Throws InputError for missing keys,
/// densities that are not positive, several IMUs, and Kalibr's scale and misalignment models, which
/// are not supported. EuRoC's T_BS is not used: results are of the IMU's own frame S, in which the
/// samples are.
ImuDescription readImuDescription(const std::string& path);

/// Reads EuRoC's imu0/data.csv: stamp [ns], angular rate xyz [rad/s], specific force xyz [m/s^2].
/// A header that names the acceleration first is honoured; one that states degrees or g is refused.
/// Throws InputError for rows that are cut, not numbers or not ascending in time, and for stamps
/// that look like another unit than ns.
std::vector<ImuSample> readImuSamples(const std::string& path);

}  // namespace plumbline
