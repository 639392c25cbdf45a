// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"

namespace plumbline {

// Kalibr's files, with its keys in its order, as text for writeFileAtomically(). Numbers read back
// to the same doubles and always have a decimal point, without which Kalibr's YAML reader takes
// 1e-05 for a word.

/// camchain-imucam.yaml, or camchain.yaml where the calibration has no IMU: T_cam_imu = T_CiC0
/// T_C0S, T_cn_cnm1 = T_CiC(i-1), timeshift_cam_imu the camera's own time
/// offset, unless that is not known. cam_overlaps names all other cameras.
std::string kalibrCamchainText(const Calibration& calibration, bool offset_known = true);

/// Kalibr's imu.yaml as it writes it, below imu0:, model calibrated.
std::string kalibrImuText(const ImuNoise& noise, const std::string& rostopic);

/// The same as Kalibr reads it (--imu): flat.
std::string kalibrImuInputText(const ImuNoise& noise, const std::string& rostopic);

/// The four densities by Kalibr's keys, a line each behind `indent`.
std::string kalibrDensities(const ImuNoise& noise, const std::string& indent);

/// cam_overlaps of a camera: "[0, 2]", the indices of all others.
std::string kalibrOverlaps(std::size_t camera, std::size_t count);

/// target.yaml of an AprilGrid.
std::string kalibrTargetText(const AprilGrid& target);

}  // namespace plumbline
