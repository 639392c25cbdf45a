// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// The oracle of the camera-IMU batch: link plumbline_camera_imu_oracle and include
// "tests/calibrator/oracle/camera_imu_oracle.h". It solves the whole problem with Ceres: corners
// one by one with automatic differentiation; between frames the pure functions preintegrate() and
// imuResidual(), whose Jacobians are proven elsewhere. Chain, border, Gram matrices, damping and
// elimination of the structured solver have no part in it.

#include <Eigen/Core>

#include "calibrator/batch/camera_imu/problem.h"

namespace plumbline::oracle {

struct CameraImuOptions {
  int max_iterations = 200;
  int threads = 1;
  bool covariance = true;  ///< whether to compute it
};

struct CameraImuSolution {
  CameraImuEstimate estimate;
  double cost = 0;  ///< as CameraImuNormals::cost
  bool converged = false;
  int iterations = 0;
  /// Of (tangent of T_SC0, time offset, and, if the problem frees them, per camera the intrinsics
  /// and, but for camera 0, the tangent of T_C0Ci), all else marginalised. Empty if not asked for.
  Eigen::MatrixXd covariance;
};

/// Minimises the problem's cost from `start`, to rounding, with the inertial weights held as given.
CameraImuSolution solveWithCeres(const CameraImuProblem& problem, const CameraImuEstimate& start,
                                 const ImuWeights& weights, const CameraImuOptions& options = {});

/// Parameters of `to` minus `from` in the order of the covariance.
Eigen::VectorXd difference(const CameraImuEstimate& to, const CameraImuEstimate& from,
                           bool free_cameras);

}  // namespace plumbline::oracle
