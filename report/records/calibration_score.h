// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/fields/calibration_fields.h"

namespace plumbline {

/// A calibration scored on a session.
struct CalibrationScore {
  std::string label;  ///< of the calibration
  std::string session;
  std::string part;       ///< "all", "fold 2 of 5"
  bool held_out = false;  ///< known not to be what it was estimated from; false: it is, or unknown
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
  std::string
      problem;  ///< what it lacks, and why: a score, that of camera and IMU, poses that converged
};

std::string partName(const CalibrationScore& score);  ///< "label/session/part"
/// The errors by camera, and the inverse.
Named<ErrorStatistics> errorsByCamera(const CalibrationScore& score);
void setErrorsByCamera(const Named<ErrorStatistics>& errors, CalibrationScore& score);

template <class V>
void fields(V& v, CalibrationScore& s) {
  v("label", s.label, "of the calibration");
  v("session", s.session, "that it was scored on");
  v("part", s.part, "`all`, `fold 2 of 5`");
  v("held_out", s.held_out, "1",
    "the session is known not to be the one that it was estimated from; false: it is, or unknown");
  v.derived("scored", s.problem.empty(), "1", "whether every score could be computed");
  v.ifSet("problem", s.problem,
          "what it lacks, and why: a score, that of camera and IMU, poses that converged");
  auto reprojection =
      s.reprojection.count > 0 ? std::optional(s.reprojection) : std::optional<ErrorStatistics>();
  v("reprojection", reprojection, "absent where no pose was found");
  auto per_camera = errorsByCamera(s);
  v("per_camera", per_camera, "by the camera's name");
  if constexpr (V::kReads) {
    if (reprojection) s.reprojection = *reprojection;
    setErrorsByCamera(per_camera, s);
  }
  v("views_used", s.views_used, "1", "(camera, frame) pairs that a pose was found for");
  v("views_offered", s.views_offered, "1", "those in the session, with or without corners");
  v("entropy_nats", s.entropy_nats, "nat", "of its own parameters on that session");
  v.ifSet("entropy_parameters", s.entropy_parameters, "which they are");
  v("camera_imu", s.camera_imu, "with IMU: only states and gravity are estimated");
  v("camera_imu_cost", s.camera_imu_cost, "1", "0.5 x sum of squared normalised residuals");
  v("gyro_rms_rad_s", s.gyro_rms_rad_s, "rad/s", "RMS of |rotation residual| / interval");
  v("accel_rms_m_s2", s.accel_rms_m_s2, "m/s^2", "RMS of |velocity residual| / interval");
  v("camera_imu_entropy_nats", s.camera_imu_entropy_nats, "nat",
    "of T_SC0 and the time offset, cameras fixed: states and gravity's direction marginalised");
  v.ifSet("camera_imu_entropy_parameters", s.camera_imu_entropy_parameters, "which they are");
}

/// Names of the cameras of all scores, each once, as they first appear.
std::vector<std::string> cameraNames(const std::vector<CalibrationScore>& scores);

/// The errors of the camera of this name; null where the score has none.
const ErrorStatistics* errorsOf(const CalibrationScore& score, const std::string& camera);

}  // namespace plumbline
