// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "calibrator/base/session.h"
#include "calibrator/base/time.h"

namespace plumbline {

using Vector9d = Eigen::Matrix<double, 9, 1>;
using Matrix9d = Eigen::Matrix<double, 9, 9>;

/// The segment of the IMU stream between two frames: [from + t_d, to + t_d] in the IMU's clock,
/// with `from` < `to` stamps of the camera's clock.
struct ImuWindow {
  TimeNs from = 0;
  TimeNs to = 0;
  double time_offset_s = 0;  ///< t_d, t_imu = t_cam + t_d

  double duration_s() const { return secondsBetween(from, to); }
};

/// Motion between the ends i, j of a window as the IMU alone knows it, in the frame S_i:
///   R = Delta R_ij,  v = int R a dt,  p = int int R a dt dt   (specific force: without gravity).
/// Derivatives are those of the discrete scheme itself, with R perturbed on the right,
/// R(x + d) = R Exp(J d); `_td` means d/dt_d of both ends moving together.
struct Preintegration {
  double duration_s = 0;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d v = Eigen::Vector3d::Zero();  ///< [m/s]
  Eigen::Vector3d p = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Matrix3d R_bg = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d v_bg = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d v_ba = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d p_bg = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d p_ba = Eigen::Matrix3d::Zero();
  Eigen::Vector3d R_td = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_td = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_td = Eigen::Vector3d::Zero();
};

/// Integrates the samples over a window. Samples are interpolated linearly, also at both ends;
/// between two stamps the rotation vector is the mean rate's plus the second-order commutator
/// dt^2/12 w0 x w1, and the rotated force is taken as linear. Error per window O(sample
/// interval^2). `samples` ascend strictly in time. Empty where they do not cover the window.
std::optional<Preintegration> preintegrate(std::span<const ImuSample> samples,
                                           const ImuWindow& window, const ImuBias& bias);

/// The derivatives by t_d of a motion that preintegrate() gave, (R_td, v_td, p_td) stacked, with
/// the rates and forces at the window's ends averaged over +- a quarter of the window:
///   R_td = w_j - R^T w_i,  v_td = R a_j - a_i - w_i x v,  p_td = v - a_i T - w_i x p.
/// For information, not for steps: the squared noise of single samples at the ends would count as
/// knowledge of t_d. (A consumer IMU at 400 Hz claims half as much again that way.)
Vector9d smoothOffsetDerivative(std::span<const ImuSample> samples, const ImuWindow& window,
                                const ImuBias& bias, const Preintegration& motion);

/// Covariance of (rotation, velocity, position) of preintegrate(), from the continuous-time white
/// noise densities alone (bias walk is a residual of its own): rotation on the right [rad],
/// velocity [m/s] and position [m] in S_i. Gyro noise reaches velocity and position through the
/// attitude. Symmetric, positive definite. Empty where the samples do not cover the window.
std::optional<Matrix9d> preintegrationCovariance(std::span<const ImuSample> samples,
                                                 const ImuWindow& window, const ImuBias& bias,
                                                 const ImuNoise& noise);

}  // namespace plumbline
