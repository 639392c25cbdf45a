// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "calibrator/base/session.h"
#include "calibrator/initialise/angular_rates.h"

namespace plumbline {

/// What the accelerometer and the camera's motion say together, by linear least squares. Standard
/// deviations take the triples as independent: those of short recordings overlap, and what their
/// noise has in common is not seen.
struct InertialAlignment {
  double scale = 1;      ///< metres per metre of the stated target; 0.5: tags stated 2 x too large
  double scale_std = 0;  ///< from the residuals
  Eigen::Vector3d t_SC0 = Eigen::Vector3d::Zero();      ///< [m]
  Eigen::Vector3d gravity_F = Eigen::Vector3d::Zero();  ///< [m/s^2], pointing down
  double gravity_std = 0;  ///< of its magnitude, from the residuals [m/s^2]
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();
  double residual_rms = 0;  ///< per component [m/s^2], over windows of about 2 span_s
  double fixed_rms = 0;     ///< the same with the scale held at 1
  /// What noise of poses and IMU explains of it, in metres of the stated target: times the scale
  /// comparable with residual_rms (residualRatio()); 0: not known.
  double noise_rms = 0;
  int equations = 0;  ///< vector equations used
};

/// Solves for scale s, t_SC0, gravity and accelerometer bias from triples of frames a, b, c: the
/// second difference of the IMU's position, p_S = s p_C0 - R_FS t_SC0, equals gravity plus the
/// pre-integrated force (velocities eliminated). Needs the rotation, gyro bias and time offset of
/// the rates' alignment. Triples that leave more than 6 robust standard deviations are left out (a
/// pose that is wrong spoils a few). `noise` is that of noise_rms. Where 1 / s does not differ from
/// zero by four deviations, is negative or off by a factor of two, and 1 leaves hardly more, or no
/// more than noise (the camera turns in place, or moves slowly), s is held at 1; its deviation
/// holds what the free one differs by. Where then hardly more than noise is left without a lever
/// arm, t_SC0 is zero. Empty for fewer than 10 usable triples.
std::optional<InertialAlignment> alignInertially(std::span<const CameraPose> poses,
                                                 std::span<const ImuSample> samples,
                                                 const Eigen::Matrix3d& R_SC0,
                                                 const Eigen::Vector3d& gyro_bias,
                                                 double time_offset_s, const ImuNoise& noise = {});

}  // namespace plumbline
