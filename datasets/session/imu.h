// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/session.h"
#include "calibrator/base/time.h"
#include "datasets/files/table.h"

namespace plumbline {

/// Throws InputError where the median interval between ascending stamps is below `shortest` [ns]:
/// no sensor of that kind is so fast, so the stamps are microseconds, milliseconds or seconds.
/// `things` are what the stamps count, for the message ("frames", "samples").
void checkStampUnit(const std::string& path, const std::vector<TimeNs>& stamps, TimeNs shortest,
                    const std::string& things);

/// What to do about a stamp that is given twice: delete a row, or, where it is so small that it may
/// be whole seconds or milliseconds since 1970, write nanoseconds.
std::string duplicateCure(TimeNs t);

/// Throws InputError where the current row's stamp is not later than that of the row before it;
/// `cure` is for a stamp that is earlier.
void checkAscending(const TextTable& table, TimeNs t, TimeNs before, const char* cure);

constexpr TimeNs kShortestFrameInterval = 1'000'000;  ///< [ns]: 1000 frames a second
constexpr TimeNs kShortestImuInterval = 25'000;       ///< [ns]: 40 000 samples a second

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
