// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/time.h"

namespace plumbline {

struct Resolution {
  int width = 0;
  int height = 0;
  bool operator==(const Resolution&) const = default;
};

/// One measured corner. Pixel (0, 0) is the centre of the first pixel (OpenCV's and Kalibr's rule).
struct Corner {
  int id = 0;  ///< corner_id of AprilGrid
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();
};

/// The corners one camera saw at one instant (the camera's own stamp). Ids are unique and
/// ascending.
struct ImageView {
  TimeNs t = 0;
  std::vector<Corner> corners;
};

/// Everything one camera recorded. Views are strictly ascending in time; views without corners are
/// kept (their number is what "offered" counts).
struct CameraStream {
  std::string name;      ///< "cam0", ...
  std::string rostopic;  ///< empty if unknown
  Resolution resolution;
  std::string camera_model;      ///< as the session states it, Kalibr's words; empty if it does not
  std::string distortion_model;  ///< likewise
  std::vector<ImageView> views;
};

/// One IMU sample in the IMU frame S. Specific force: a resting, upright accelerometer reads +g up.
struct ImuSample {
  TimeNs t = 0;
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< [rad/s]
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< [m/s^2]
};

/// Continuous-time noise densities, as in Kalibr's imu.yaml.
struct ImuNoise {
  double gyro_density = 1.6968e-4;      ///< [rad/s/sqrt(Hz)]
  double gyro_random_walk = 1.9393e-5;  ///< [rad/s^2/sqrt(Hz)]
  double accel_density = 2.0e-3;        ///< [m/s^2/sqrt(Hz)]
  double accel_random_walk = 3.0e-3;    ///< [m/s^3/sqrt(Hz)]
  double rate_hz = 200;                 ///< nominal sample rate
};

/// What every estimation assumes of its measurements: the one home of these defaults. Options of
/// stages, windows and guides begin with it, and pass it on whole.
struct MeasurementModel {
  double pixel_sigma = 1;         ///< standard deviation of a corner, per axis [px]
  double cauchy_px = 3;           ///< scale of the Cauchy loss on |e| [px]; 0: squared error
  double gravity_m_s2 = 9.80655;  ///< magnitude of gravity; its direction is estimated
  std::optional<ImuNoise> noise;  ///< in place of the session's densities

  MeasurementModel& model() { return *this; }
  const MeasurementModel& model() const { return *this; }

  /// Throws InputError unless sigma, gravity and densities are positive, and the loss is 0 or at
  /// least 1e-3 px.
  void check() const;
};

struct ImuStream {
  std::string rostopic;
  ImuNoise noise;
  std::vector<ImuSample> samples;  ///< strictly ascending in time
};

/// A recording: what the calibrator works on. All stamps are in one clock (camera and IMU stamps
/// may differ by the time offset that is to be estimated).
struct Session {
  std::string name;
  AprilGrid target;
  std::vector<CameraStream> cameras;
  std::optional<ImuStream> imu;
};

/// What an IMU adds to the truth, apart from white noise.
struct ImuBias {
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< [rad/s]
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< [m/s^2]
};

}  // namespace plumbline
