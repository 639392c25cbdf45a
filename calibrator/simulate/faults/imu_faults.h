// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "calibrator/simulate/simulate_session.h"

namespace plumbline {

/// What a triad pair reads before bias and noise.
struct ImuReading {
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< [rad/s]
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< [m/s^2]
};

/// The IMU's faulty reading of an exact motion, in closed form (no integrator, no interpolation):
///   gyro(t)  = M_g omega(t - d_g) + k f(t - d_g)
///   accel(t) = M_a (f(t - d_a) + sum n A sin(2 pi h (t - d_a)))
/// with omega and f in S, or in the turned S after a slip; M the product of scales, misalignments
/// and skewed axes in the order given; d the sums of delays. Without faults: omega and f to the
/// last bit.
class ImuFaults {
 public:
  /// Keeps pointers into `faults`.
  explicit ImuFaults(const std::vector<Fault>& faults);

  /// At t_s of the trajectory; gravity_F points down [m/s^2].
  ImuReading read(const AnalyticTrajectory& trajectory, const Eigen::Vector3d& gravity_F,
                  double t_s) const;

 private:
  /// Of S, or of the slipped IMU frame.
  MotionState motion(const AnalyticTrajectory& trajectory, double t_s) const;

  Eigen::Matrix3d M_gyro_ = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d M_accel_ = Eigen::Matrix3d::Identity();
  double gyro_delay_s_ = 0;
  double accel_delay_s_ = 0;
  double g_sensitivity_ = 0;
  std::vector<NumberedFault> vibrations_;
  std::vector<NumberedFault> slips_;
};

/// Where the recording stands.
struct ImuTiming {
  TimeNs start_ns = 0;  ///< t = 0, the first frame
  double rate_hz = 0;   ///< of the samples
  std::uint64_t seed = 0;
};

/// Applies to samples with noise and bias, in this order: bias jumps (to the biases, too),
/// clipping, spikes, gaps, bursts, steps and drift of the clock. Samples whose stamps would not
/// ascend are lost. Numbers of the spikes depend on a sample's distance from start_ns only. Returns
/// the stamps that spikes struck, one list per fault of `faults`.
std::vector<std::vector<TimeNs>> disturbSamples(ImuRecording& recording,
                                                const std::vector<Fault>& faults,
                                                const ImuTiming& timing);

}  // namespace plumbline
