// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline::test {

/// A short recording without any noise; IMU samples are those of the analytic trajectory.
inline SimulationOptions exactRecording(double imu_rate_hz, double duration_s = 5) {
  SimulationOptions options;
  options.duration_s = duration_s;
  options.imu_rate_hz = imu_rate_hz;
  options.imu_noise = false;
  options.corner_sigma_px = 0;
  return options;
}

/// A short recording with the noise of its rig and 0.2 px of corner noise.
inline SimulationOptions noisyRecording(std::uint64_t seed, double duration_s = 5) {
  SimulationOptions options;
  options.duration_s = duration_s;
  options.seed = seed;
  options.corner_sigma_px = 0.2;
  return options;
}

inline SimulatedSession simulate(const SimulationOptions& options,
                                 const std::string& rig = "euroc") {
  return simulateSession(simulatedRig(rig), options);
}

/// Squared error, the simulation's pixel noise and gravity: what makes estimates unbiased and
/// covariances honest. The noise is not judged: a fifth of the time, for tests of that alone.
inline CameraImuOptions matchedOptions(const SimulatedSession& simulated, double pixel_sigma) {
  CameraImuOptions options;
  options.cauchy_px = 0;
  options.pixel_sigma = pixel_sigma;
  options.gravity_m_s2 = simulated.gravity_F.norm();
  options.noise_check = false;
  return options;
}

/// Tangent-space error of the estimate (truth minus estimate): T_SC0 (6), time offset [s].
inline Eigen::Matrix<double, 7, 1> calibrationError(const SimulatedSession& simulated,
                                                    const CameraImuStageResult& result) {
  Eigen::Matrix<double, 7, 1> error;
  error << boxminus(simulated.truth.imu->T_SC0, result.imu.T_SC0),
      simulated.truth.imu->timeOffset() - result.imu.timeOffset();
  return error;
}

/// What a covariance C of the cameras, or of these and the board's terms, adds to that of T_SC0 and
/// the time offset, to first order (batch/two_stages.h).
inline Eigen::Matrix<double, 7, 7> addedByCameras(const CameraImuStageResult& result,
                                                  const Eigen::MatrixXd& C) {
  const Eigen::MatrixXd& J = result.faults->by_cameras;  // without tag_edge, the last term
  const Eigen::Index n = std::min(J.cols(), C.cols());
  return J.leftCols(n) * C.topLeftCorner(n, n) * J.leftCols(n).transpose();
}

}  // namespace plumbline::test
