// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/session.h"
#include "calibrator/base/transform.h"

namespace plumbline {

/// What the camera-IMU tool prints of one error: of the norms of its residuals.
struct KalibrErrorStatistics {
  double mean = 0;
  double median = 0;
  double std = 0;  ///< ddof 0
  /// Old versions print statistics of the squared norms.
  bool of_squares = false;

  /// Root mean square of the norm: sqrt(mean^2 + std^2); sqrt(mean) where it is of squares.
  double rms() const;
};

/// What the camera tool prints of one camera's reprojection error, per axis [px].
struct KalibrAxisStatistics {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d std = Eigen::Vector2d::Zero();

  /// Root mean square of the error's norm: sqrt(mx^2 + my^2 + sx^2 + sy^2) [px].
  double rms() const;
};

struct KalibrTextCamera {
  std::string name;      ///< "cam0"
  std::string rostopic;  ///< empty in the camera-IMU tool's file
  // The camera tool's.
  std::optional<KalibrAxisStatistics> axis_error_px;
  Eigen::VectorXd projection, projection_std;  ///< in Kalibr's order, rounded; empty if not printed
  Eigen::VectorXd distortion, distortion_std;
  /// The previous camera into this one, from q and t of its baseline (q's order is not stated: x,
  /// y, z, w of the conjugate, as in poses-*.csv).
  std::optional<Transform> T_cn_cnm1;
  // The camera-IMU tool's.
  std::optional<KalibrErrorStatistics> normalised_error;  ///< in standard deviations of a corner
  std::optional<KalibrErrorStatistics> error_px;          ///< missing in old versions
  std::optional<Transform> T_cam_imu;                     ///< IMU into this camera, rounded
  std::optional<double> timeshift_cam_imu;                ///< t_imu = t_cam + shift [s]

  /// RMS of the reprojection error [px], of either tool; nothing where only normalised errors
  /// stand.
  std::optional<double> rmsPx() const;
};

/// results-*.txt. Parameter values are rounded here: take them from the YAML.
struct KalibrResults {
  enum class Tool { kCameras, kCameraImu };
  std::string path;
  Tool tool = Tool::kCameras;
  std::vector<KalibrTextCamera> cameras;
  std::optional<KalibrErrorStatistics> gyro_normalised, accel_normalised;
  std::optional<KalibrErrorStatistics> gyro_rad_s;  ///< missing in old versions
  std::optional<KalibrErrorStatistics> accel_m_s2;  ///< likewise
  std::optional<Eigen::Vector3d> gravity_F;         ///< in target coordinates [m/s^2]
  std::optional<ImuNoise> noise;                    ///< continuous-time densities
  std::string imu_model;                            ///< "calibrated"; empty if not printed
};

/// Reads the text of both tools, in their layouts since 2014. Throws InputError, with file and
/// line, for a file that is none, one that ends early, and results that are not finite (the
/// optimisation diverged).
KalibrResults readKalibrResults(const std::string& path);

}  // namespace plumbline
