// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/time.h"
#include "calibrator/simulate/faults/fault.h"
#include "calibrator/simulate/trajectory.h"

namespace plumbline {

/// What is recorded and how it is disturbed. The defaults are a plausible noisy recording.
struct SimulationOptions {
  std::uint64_t seed = 1;        ///< of all noise; the motion has its own, trajectory.seed
  TrajectoryOptions trajectory;  ///< motion of the rig
  AprilGrid target;
  double duration_s = 60;                       ///< first to last frame, about
  std::optional<double> camera_rate_hz;         ///< the rig's unless given
  std::optional<double> imu_rate_hz;            ///< the rig's unless given
  std::optional<double> time_offset_s;          ///< t_imu = t_cam + t_d; the rig's unless given
  TimeNs start_ns = 1'400'000'000'123'456'789;  ///< stamp of the first frame
  double imu_margin_s = 0.5;  ///< IMU samples before the first and after the last exposure;
                              ///< negative: the first and last exposures are not covered

  double corner_sigma_px = 0.2;  ///< standard deviation of u and of v; 0: exact
  double outlier_fraction = 0;   ///< probability that a corner is displaced grossly, [0, 1]
  double outlier_px = 10;        ///< outliers move by 0.5 to 1.5 times this, in any direction
  double dropped_fraction = 0;   ///< probability that a camera loses a frame, [0, 1]
  double stamp_jitter_s = 0;     ///< each camera's exposures differ from the common instants by
                                 ///< up to half of this; stamped with their own times
  double border_px = 5;          ///< tags that come closer to the image's border are not seen
  double min_tag_px = 8;         ///< nor are tags with a side shorter than this

  bool imu_noise = true;  ///< white noise and bias walk of the rig's densities; false: exact
  Eigen::Vector3d initial_gyro_bias{0.004, -0.002, 0.003};  ///< at start_ns [rad/s]
  Eigen::Vector3d initial_accel_bias{0.05, -0.03, 0.08};    ///< at start_ns [m/s^2]
  Eigen::Vector3d down_F{0.03, -1.0,
                         -0.05};  ///< direction of gravity in F, any length; not along x

  std::vector<Fault> faults;  ///< what is wrong with the recording; checked by simulateSession()

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

}  // namespace plumbline
