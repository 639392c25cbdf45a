// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "calibrator/simulate/simulate_session.h"

namespace plumbline {

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
///   uv = project(T_BC(t')^-1 p_B),  T_BC(t) = T_FB(t)^-1 T_FS(t) M(t) T_SC0 T_C0Ci Exp(bump),
///   t' = t + readout ((v + 0.5) / h - 0.5) + column_readout ((u + 0.5) / w - 0.5) + exposure x,
/// M the turn of a soft mount, B the board as it is displaced in F, p_B its real corner (stretch,
/// bow), x uniform for every corner. The place (u, v) is found by fixed-point iteration to 1e-10
/// px. Without faults, the same bits as visibleCorners() at the true pose.
class ViewFaults {
 public:
  /// Keeps references to `simulated` and `options`.
  ViewFaults(const SimulatedSession& simulated, int index, const SimulationOptions& options);

  /// T_BC at t_s of the trajectory.
  Transform cameraPose(double t_s) const;
  /// Corners of the frame without noise, ids ascending.
  std::vector<Corner> corners(const FaultyFrame& frame) const;

 private:
  bool isRolling() const { return readout_s_ != 0 || column_readout_s_ != 0; }
  /// Specific force in S.
  Eigen::Vector3d force(double t_s) const;
  /// Of a corner at p before these faults.
  Eigen::Vector3d boardCorner(int id, Eigen::Vector3d p) const;
  std::optional<Eigen::Vector2d> seeWhenExposed(const Eigen::Vector3d& p_B, double t_s) const;
  std::vector<double> blurShifts(const FaultyFrame& frame) const;

  const SimulatedSession& simulated_;
  const SimulationOptions& options_;
  std::size_t camera_;
  double readout_s_ = 0;         ///< of the rows
  double column_readout_s_ = 0;  ///< of the columns
  std::vector<NumberedFault> bumps_, displacements_, shapes_, blurs_, mounts_;
  Eigen::Vector3d mean_force_ = Eigen::Vector3d::Zero();  ///< where there is a soft mount
};

/// What happens to the detected corners of camera `index`, in this order: false corners, swapped
/// ids, frozen frames, and appends to `injected` (one per fault of the options) which views the
/// latter two struck. `frames`: one per view of `stream`.
void disturbViews(CameraStream& stream, const std::vector<FaultyFrame>& frames, int index,
                  const SimulationOptions& options, std::vector<InjectedFault>& injected);

}  // namespace plumbline
