// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "calibrator/residuals/preintegration.h"

namespace plumbline {

/// Faults of IMU samples that the calibration does not model, as columns of a linear model around
/// "no fault". With the true rate w and specific force a, bias apart:
///   gyro  = (I + M_g) w + G a,      accel(t) = (I + M_a) a(t - d).
/// Columns: M_a row by row (9), M_g row by row (9), G row by row (9) [rad/s per m/s^2], d [s].
struct SampleFaults {
  static constexpr int kAccel = 0;
  static constexpr int kGyro = 9;
  static constexpr int kGSensitivity = 18;
  static constexpr int kDelay = 27;
  static constexpr int kCount = 28;
};

/// What the faults do to a pre-integrated motion: derivatives of (rotation on the right [rad], v
/// [m/s], p [m]) as preintegrate() would give them from samples from which the fault was removed,
/// so that a residual's derivative is minus these. With psi the rotation's change in S_i,
///   psi' = R dw,   v' = psi x (R a) + R da,   p' = v,
/// by the midpoint rule over the samples (error of the derivative O(interval^2)); the slope of the
/// force, which the delay needs, over five intervals. Empty where the samples do not cover the
/// window.
std::optional<Eigen::Matrix<double, 9, SampleFaults::kCount>> sampleFaultDerivatives(
    std::span<const ImuSample> samples, const ImuWindow& window, const ImuBias& bias);

}  // namespace plumbline
