// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/simulate/faults/imu_faults.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {

/// IMU samples with the biases that are in them.
struct SimulatedImu : ImuRecording {
  std::vector<std::vector<TimeNs>> fault_stamps;  ///< see disturbSamples()
};

/// Samples of an IMU on `trajectory`, see simulateSession(). `imu` states the true offset and
/// densities, with noise.rate_hz the rate; `gravity_F` points down [m/s^2].
SimulatedImu simulateImu(const AnalyticTrajectory& trajectory, const ImuCalibration& imu,
                         const Eigen::Vector3d& gravity_F, const SimulationOptions& options);

}  // namespace plumbline
