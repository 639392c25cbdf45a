// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "calibrator/base/calibration.h"

namespace plumbline {

/// t_d of camera `i`, t_imu = t_cam_i + t_d_i [s].
inline double cameraTimeOffset(const ImuCalibration& imu, std::size_t i) {
  return i < imu.camera_time_offsets_s.size() ? imu.camera_time_offsets_s[i] : imu.time_offset_s;
}

/// Mean of the cameras' time offsets [s]: what a tool with one offset for all compares with
/// (Kalibr estimates one for each camera; ours is one unless the cameras are not synchronised).
inline double meanTimeOffset(const ImuCalibration& imu) {
  if (imu.camera_time_offsets_s.empty()) return imu.time_offset_s;
  double sum = 0;
  for (const double offset : imu.camera_time_offsets_s) sum += offset;
  return sum / static_cast<double>(imu.camera_time_offsets_s.size());
}

}  // namespace plumbline
