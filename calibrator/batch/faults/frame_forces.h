// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrator/batch/camera_imu/problem.h"

namespace plumbline {

/// Specific force of the rig at every frame, in S [m/s^2], less its mean.
///
/// From the accelerometer's readings on either side, linearly, where their own noise s is small: s
/// <= a tenth of what they vary by, s from their distances to the middle of their neighbours (by
/// the median). Otherwise the noise of a reading, which the inertial residuals have as well, would
/// correlate with them: a fault in proportion to the force would be found in every recording, of
/// about dt T s^2 / (2 var f) [m per m/s^2], dt and T the intervals of samples and frames. There it
/// is R^T ((v_k+1 - v_k-1) / (t_k+1 - t_k-1) - g) of the estimated states, which the corners
/// decide.
std::vector<Eigen::Vector3d> frameForces(const CameraImuProblem& problem,
                                         const CameraImuEstimate& estimate);

}  // namespace plumbline
