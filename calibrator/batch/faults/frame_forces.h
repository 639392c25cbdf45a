// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrator/batch/camera_imu/problem.h"

namespace plumbline {

/// Specific force of the rig at every frame, in S [m/s^2], less its mean.
///
/// From the accelerometer's readings on either side, linearly, where their own noise is at most a
/// tenth of what the force varies by; the noise by their distances to the middle of their
/// neighbours (by the median). Otherwise a reading's noise, which the inertial residuals have as
/// well, correlates with them: recordings of `simulate operator` (0.5 m/s^2 a reading) showed T_SC0
/// moved by 0.1 mm per m/s^2. There the force is R^T ((v_k+1 - v_k-1) / (t_k+1 - t_k-1) - g) of the
/// estimated states.
std::vector<Eigen::Vector3d> frameForces(const CameraImuProblem& problem,
                                         const CameraImuEstimate& estimate);

}  // namespace plumbline
