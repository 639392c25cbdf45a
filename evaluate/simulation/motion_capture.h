// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

#include "calibrator/base/transform.h"
#include "calibrator/fields/json_fields.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {

/// A motion-capture system that watches a simulated rig: poses T_VM of a marker body in its own
/// world, by its own clock, with noise and gaps.
struct MotionCaptureOptions {
  double rate_hz = 100;
  double clock_offset_s = 0.037;  ///< t_imu = t_mocap + this
  Transform T_SM{Eigen::Quaterniond(0.97, 0.1, -0.05, 0.2),
                 Eigen::Vector3d(0.03, -0.06, 0.08)};  ///< the marker body in the IMU frame
  Transform T_VW{Eigen::Quaterniond(0.8, 0, 0, 0.6), Eigen::Vector3d(1.2, -0.7, 0.9)};
  double noise_m = 3e-4;
  double noise_rad = 1e-3;
  int drop_outs = 2;        ///< gaps at random places, away from the ends
  double drop_out_s = 0.6;  ///< length of each
  std::uint64_t seed = 1;

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

struct MotionCapture {
  Trajectory trajectory;                          ///< T_VM, stamps of its own clock
  std::vector<std::pair<double, double>> gaps_s;  ///< begin and end [s after the first frame]
};

MotionCapture simulateMotionCapture(const SimulatedSession& session,
                                    const MotionCaptureOptions& options);

/// Lets a system watch the session and writes FOLDER/PLACE/mav0/mocap0/data.csv, FOLDER being the
/// output's. Returns the system's truth: clock_offset_s, T_SM, T_VW, noise and gaps.
Json writeMotionCapture(const SimulatedSession& session, const MotionCaptureOptions& options,
                        const std::filesystem::path& folder, const std::filesystem::path& place);

}  // namespace plumbline
