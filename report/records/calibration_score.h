// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/statistics.h"

namespace plumbline {

/// A calibration scored on a session that it did not see (or did: `held_out` tells).
struct CalibrationScore {
  std::string label;  ///< of the calibration
  std::string session;
  std::string part;  ///< "all", "fold 2 of 5"
  bool held_out = false;
  ErrorStatistics reprojection;
  std::vector<ErrorStatistics> per_camera;
  std::vector<std::string> cameras;           ///< their names; sessions may order them otherwise
  int views_used = 0;                         ///< (camera, frame) pairs that a pose was found for
  int views_offered = 0;                      ///< those in the session, whatever they saw
  std::optional<ErrorStatistics> camera_imu;  ///< with IMU: only states and gravity move
  std::optional<double> camera_imu_cost;      ///< 0.5 * sum of squared normalised residuals
  std::optional<double> gyro_rms_rad_s;
  std::optional<double> accel_rms_m_s2;
  std::optional<double> entropy_nats;  ///< of its own parameters on that session
  std::vector<std::string> entropy_parameters;
  /// The same of T_SC0 and the time offset, the cameras held: states and gravity's direction
  /// marginalised, the differences between the cameras' own offsets held.
  std::optional<double> camera_imu_entropy_nats;
  std::vector<std::string> camera_imu_entropy_parameters;
  std::string problem;  ///< why there is no score, or none of camera and IMU; empty if there is
};

/// Names of the cameras of all scores, each once, as they first appear.
std::vector<std::string> cameraNames(const std::vector<CalibrationScore>& scores);

/// The errors of the camera of this name; null where the score has none.
const ErrorStatistics* errorsOf(const CalibrationScore& score, const std::string& camera);

}  // namespace plumbline
