// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "calibrator/initialise/imu_rates.h"

namespace plumbline {

/// What the accelerometer and the camera's motion say together, by linear least squares.
struct InertialAlignment {
  double scale = 1;      ///< metres per metre of the stated target; 0.5: tags stated 2 x too large
  double scale_std = 0;  ///< from the residuals
  Eigen::Vector3d t_SC0 = Eigen::Vector3d::Zero();      ///< [m]
  Eigen::Vector3d gravity_F = Eigen::Vector3d::Zero();  ///< [m/s^2], pointing down
  double gravity_std = 0;  ///< of its magnitude, from the residuals [m/s^2]
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();
  double residual_rms = 0;  ///< per component [m/s^2], over windows of about 2 span_s
  double fixed_rms = 0;     ///< the same with the scale held at 1
  double noise_rms = 0;     ///< the same as noise of poses and IMU explains it; 0: not known
  int equations = 0;        ///< vector equations used
};

struct InertialAlignmentOptions {
  double span_s = 0.2;            ///< time between the frames of a triple [s]
  int max_triples = 300;          ///< spread evenly over the recording
  ImuNoise noise;                 ///< for noise_rms
  double t_SC0_prior_m = 1.0;     ///< standard deviations of zero-mean priors, so that motion that
  double accel_bias_prior = 0.3;  ///< says nothing of them leaves them at zero

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// Solves for scale s, t_SC0, gravity and accelerometer bias from triples of frames a, b, c: the
/// second difference of the IMU's position, p_S = s p_C0 - R_FS t_SC0, equals gravity plus the
/// pre-integrated force (velocities eliminated). Needs the rotation, gyro bias and time offset of
/// the rates' alignment. Triples that leave more than 6 robust standard deviations are left out (a
/// pose that is wrong spoils a few). Empty for fewer than 10 usable triples.
std::optional<InertialAlignment> alignInertially(std::span<const CameraPose> poses,
                                                 std::span<const ImuSample> samples,
                                                 const Eigen::Matrix3d& R_SC0,
                                                 const Eigen::Vector3d& gyro_bias,
                                                 double time_offset_s,
                                                 const InertialAlignmentOptions& options = {});

}  // namespace plumbline
