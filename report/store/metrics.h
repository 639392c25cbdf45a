// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "report/records/calibration_record.h"

namespace plumbline::store_internal {

struct Metric {
  std::string stage;  ///< "camera", "camera_imu", "label/session/part" of a score
  std::string name;   ///< as in calibration.json, with its unit at the end
  std::string unit;
  double value = 0;
};

/// The numbers of a record that a study compares between runs: errors, counts, entropy, seconds,
/// and of the camera-IMU stage the inertial residuals.
std::vector<Metric> metricsOf(const CalibrationRecord& record);

/// RMSE (all, per camera, with IMU) and entropies of each score, and whether there is one.
std::vector<Metric> metricsOf(const std::vector<CalibrationScore>& scores);

}  // namespace plumbline::store_internal
