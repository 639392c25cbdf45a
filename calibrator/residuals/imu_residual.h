// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "calibrator/base/results/imu_residuals.h"
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
/// The motion with these in place of its own derivatives by t_d.
Preintegration withSmoothOffset(std::span<const ImuSample> samples, const ImuWindow& window,
                                const ImuBias& bias, Preintegration motion);

/// Covariance of (rotation, velocity, position) of preintegrate(), from the continuous-time white
/// noise densities alone (bias walk is a residual of its own): rotation on the right [rad],
/// velocity [m/s] and position [m] in S_i. Gyro noise reaches velocity and position through the
/// attitude. Symmetric, positive definite. Empty where the samples do not cover the window.
std::optional<Matrix9d> preintegrationCovariance(std::span<const ImuSample> samples,
                                                 const ImuWindow& window, const ImuBias& bias,
                                                 const ImuNoise& noise);

using Vector15d = Eigen::Matrix<double, 15, 1>;

/// Tangent of an ImuState, 15: T_FS (translation additive in F, rotation on the left), velocity,
/// gyro bias, accelerometer bias.
ImuState boxplus(const ImuState& state, const Vector15d& d);
/// The d with boxplus(from, d) == to.
Vector15d boxminus(const ImuState& to, const ImuState& from);

/// An orthonormal basis (columns) of the plane normal to the unit vector `direction`.
Eigen::Matrix<double, 3, 2> tangentBasis(const Eigen::Vector3d& direction);
/// Moves a unit vector along the great circle that leaves it in the direction of
/// tangentBasis(direction) * d; |d| is the angle [rad].
Eigen::Vector3d boxplusDirection(const Eigen::Vector3d& direction, const Eigen::Vector2d& d);

/// Gravity in the target's frame: known magnitude, unknown direction (2 dof).
struct Gravity {
  Eigen::Vector3d direction = -Eigen::Vector3d::UnitZ();  ///< unit vector in F, pointing down
  double magnitude = MeasurementModel().gravity_m_s2;     ///< [m/s^2]
};

/// Residual of the IMU between frames i and j, raw (not whitened), with its Jacobians:
///   r_R = Log(Delta R^T R_i^T R_j)                             [rad]
///   r_v = R_i^T (v_j - v_i - g T) - Delta v                    [m/s]
///   r_p = R_i^T (p_j - p_i - v_i T - g T^2 / 2) - Delta p      [m]
/// `motion` is pre-integrated with the biases of state i (Forster et al., RSS 2015, with the whole
/// integral redone in place of the bias correction to first order). Columns: state i as in
/// boxplus(ImuState); state j without its biases, on which r does not depend; gravity as in
/// boxplusDirection; t_d.
struct ImuResidual {
  Vector9d r;
  Eigen::Matrix<double, 9, 15> J_i;
  Eigen::Matrix<double, 9, 9> J_j;
  Eigen::Matrix<double, 9, 2> J_gravity;
  Vector9d J_offset;
};
ImuResidual imuResidual(const Preintegration& motion, const ImuState& i, const ImuState& j,
                        const Gravity& gravity);

/// Residual of the bias random walk: (bg_j - bg_i, ba_j - ba_i); Jacobian -I and +I.
Vector6d biasWalkResidual(const ImuState& i, const ImuState& j);

/// Whitening of an interval: normalised = sqrt_information * r, and bias walks divided by their
/// standard deviation (density * sqrt(T)).
struct ImuWeight {
  Matrix9d sqrt_information = Matrix9d::Zero();  ///< lower triangular, inverse Cholesky factor
  double gyro_walk = 0;                          ///< 1 / standard deviation [s/rad]
  double accel_walk = 0;                         ///< [s^2/m]

  Vector6d walk() const;  ///< of the rows of biasWalkResidual()
};
/// From preintegrationCovariance() (symmetric positive definite) and the walk densities.
ImuWeight imuWeight(const Matrix9d& covariance, const ImuNoise& noise, double duration_s);
/// Of the bias walk alone: for a pair of frames without usable IMU samples in between.
ImuWeight biasWalkWeight(const ImuNoise& noise, double duration_s);

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
