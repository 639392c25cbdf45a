// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
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

/// A frame of one camera: when it was exposed and what it was stamped with.
struct FaultyFrame {
  std::uint64_t number = 0;  ///< selects its random numbers
  double t_s = 0;            ///< middle of the exposure, in the trajectory's time
  TimeNs stamp = 0;
};

/// The frames of camera `index` less those lost, stamps strictly ascending: simulateStamps() with
/// exposure-shift, jitter and restamp. Frames whose stamps would not ascend are lost.
std::vector<FaultyFrame> faultyFrames(const SimulatedSession& simulated, int index,
                                      const SimulationOptions& options);

/// The target as the session states it: wrong-size.
AprilGrid statedTarget(const SimulationOptions& options);

/// How one camera sees the real target, on the closed form of the trajectory. With t the exposure:
///   uv = project(T_BC(t')^-1 p_B),  T_BC(t) = T_FB(t)^-1 T_FS(t) T_SC0 T_C0Ci Exp(bump),
///   t' = t + readout ((v + 0.5) / h - 0.5) + exposure u,
/// B the board as it is displaced in F, p_B its real corner (stretch, bow), u uniform for every
/// corner. The row v is found by fixed-point iteration to 1e-10 px. Without faults, the same bits
/// as visibleCorners() at the true pose.
class ViewFaults {
 public:
  /// Keeps references to `simulated` and `options`.
  ViewFaults(const SimulatedSession& simulated, int index, const SimulationOptions& options);

  /// T_BC at t_s of the trajectory.
  Transform cameraPose(double t_s) const;
  /// Corners of the frame without noise, ids ascending.
  std::vector<Corner> corners(const FaultyFrame& frame) const;

 private:
  /// Of a corner at p before these faults.
  Eigen::Vector3d boardCorner(int id, Eigen::Vector3d p) const;
  std::optional<Eigen::Vector2d> seeInRow(const Eigen::Vector3d& p_B, double t_s) const;
  std::vector<double> blurShifts(const FaultyFrame& frame) const;

  const SimulatedSession& simulated_;
  const SimulationOptions& options_;
  std::size_t camera_;
  double readout_s_ = 0;
  std::vector<NumberedFault> bumps_, displacements_, shapes_, blurs_;
};

/// What happens to the detected corners of camera `index`, in this order: false corners, swapped
/// ids, frozen frames, and appends to `injected` (one per fault of the options) which views the
/// latter two struck. `frames`: one per view of `stream`.
void disturbViews(CameraStream& stream, const std::vector<FaultyFrame>& frames, int index,
                  const SimulationOptions& options, std::vector<InjectedFault>& injected);

}  // namespace plumbline
