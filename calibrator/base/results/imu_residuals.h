// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "calibrator/base/time.h"
#include "calibrator/base/transform.h"

namespace plumbline {

/// State of the sensor at a camera frame, in the target's frame F (no gauge freedom remains there).
struct ImuState {
  Transform T_FS;
  Eigen::Vector3d v_F = Eigen::Vector3d::Zero();         ///< [m/s]
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();   ///< [rad/s]
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();  ///< [m/s^2]
};

/// What one of the IMU's sensors read on average between two frames, in the IMU's axes at the
/// earlier one, beside what the solution's states say that it should have read.
///   gyroscope:      measured Log(Delta R) / T + b_g,  predicted Log(R_i^T R_j) / T + b_g [rad/s]
///   accelerometer:  Delta v / T + b_a,  R_i^T ((v_j - v_i) / T - g) + b_a [m/s^2]
/// with the pre-integrated Delta R, Delta v, gravity g and the biases of state i.
struct MeanReading {
  Eigen::Vector3d measured = Eigen::Vector3d::Zero();
  Eigen::Vector3d predicted = Eigen::Vector3d::Zero();
  /// Of `measured`, by the assumed noise density of the samples alone.
  Eigen::Vector3d std = Eigen::Vector3d::Zero();
};

/// Residual of the IMU between two consecutive frames at the solution.
struct ImuIntervalResidual {
  TimeNs t = 0;     ///< of the earlier frame, camera clock
  double dt_s = 0;  ///< length of the interval
  Eigen::Vector3d rotation_rad = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  /// Whitened by the assumed noise; unit variance where the assumption holds. Rotation, velocity,
  /// position (jointly whitened), gyro bias walk, accel bias walk.
  Eigen::Matrix<double, 15, 1> normalised = Eigen::Matrix<double, 15, 1>::Zero();
  MeanReading gyro;   ///< [rad/s]
  MeanReading accel;  ///< [m/s^2]
};

/// What one group of inertial residuals says of the density that was assumed for it.
struct ImuNoiseCheck {
  /// Normalised RMS to expect at the solution if every assumption holds, pixel_sigma too: sqrt(mean
  /// of 1 - leverage), below 1, for each frame's own states absorb most of the residual.
  double expected_rms = 0;
  /// By how much the density should be multiplied: above 1 it is too small, below too large. 1 also
  /// where the redundancy is too low to tell.
  double factor = 1;
  /// How many residuals' worth the group has to say, once factors are applied. The factor's
  /// relative standard deviation is 1 / sqrt(2 redundancy) or somewhat more.
  double redundancy = 0;
};

/// The checks of all groups; see checkImuNoise() (calibrator/batch/camera_imu/stage.h).
struct ImuNoiseChecks {
  ImuNoiseCheck gyro;        ///< rotation rows
  ImuNoiseCheck accel;       ///< velocity and position rows
  ImuNoiseCheck gyro_bias;   ///< random walk
  ImuNoiseCheck accel_bias;  ///< random walk
  /// Standard deviation of a corner, per axis, that explains the poses' noise [px]: above that of
  /// the reprojection errors where a view's corners err together. 0 where the poses do not tell it.
  double pose_pixel_sigma = 0;
};

/// What the inertial residuals say of the noise that was assumed.
struct ImuResidualSummary {
  double gyro_rms_rad_s = 0;        ///< RMS of |rotation residual| / dt
  double accel_rms_m_s2 = 0;        ///< RMS of |velocity residual| / dt
  double gyro_normalised_rms = 0;   ///< at the solution, per component, rotation rows; for what to
                                    ///< expect of it, which is not 1, see `noise`
  double accel_normalised_rms = 0;  ///< velocity and position rows
  double gyro_bias_normalised_rms = 0;
  double accel_bias_normalised_rms = 0;
  double chi2 = 0;  ///< sum of squared normalised residuals
  int dof = 0;      ///< their number
  ImuNoiseChecks noise;
};

/// How far the poses that frames and IMU share are from those that each frame's own corners would
/// choose, to first order. A shift of a frame's stamp is one of a pose's six directions.
struct FrameErrors {
  double rmse_px = 0;       ///< at the solution
  double free_rmse_px = 0;  ///< with every frame at the pose of its own corners
  double along = 0;   ///< squared error that a shift of its stamp takes from a frame, mean [px^2]
  double across = 0;  ///< that each of the other five directions takes, mean [px^2]
  double neighbours = 0;  ///< correlation of the shifts of frames that follow each other
  double jitter_s = 0;    ///< RMS of the shifts, less what directions take by chance

  /// Standard deviation of a corner about its frame's own pose, per axis [px].
  double freeSigma() const { return free_rmse_px / std::sqrt(2.0); }
};

}  // namespace plumbline
