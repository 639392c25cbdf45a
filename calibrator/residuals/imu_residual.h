// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "calibrator/base/measurement_model.h"
#include "calibrator/base/results.h"
#include "calibrator/residuals/preintegration.h"

namespace plumbline {

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
};
/// From preintegrationCovariance() (symmetric positive definite) and the walk densities.
ImuWeight imuWeight(const Matrix9d& covariance, const ImuNoise& noise, double duration_s);
/// Of the bias walk alone: for a pair of frames without usable IMU samples in between.
ImuWeight biasWalkWeight(const ImuNoise& noise, double duration_s);

}  // namespace plumbline
