// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "calibrator/simulate/simulate_session.h"

namespace plumbline::test {

/// Exact samples and corners, no bias.
inline SimulationOptions soundRecording(double duration_s = 4) {
  SimulationOptions o;
  o.duration_s = duration_s;
  o.corner_sigma_px = 0;
  o.imu_noise = false;
  o.initial_gyro_bias.setZero();
  o.initial_accel_bias.setZero();
  return o;
}

inline SimulatedSession withFaults(SimulationOptions o, std::vector<Fault> faults) {
  o.faults = std::move(faults);
  return simulateSession(simulatedRig("euroc"), o);
}

/// Specific force in S [m/s^2].
inline Eigen::Vector3d forceOf(const MotionState& m, const Eigen::Vector3d& gravity_F) {
  return m.T_FB.R.transpose() * (m.a_F - gravity_F);
}

/// All corners of a session by (camera, stamp, id).
using CornersById = std::map<std::tuple<int, TimeNs, int>, Eigen::Vector2d>;

inline CornersById cornersById(const SimulatedSession& s) {
  CornersById all;
  for (int i = 0; i < static_cast<int>(s.session.cameras.size()); ++i) {
    for (const ImageView& view : s.session.cameras[static_cast<std::size_t>(i)].views) {
      for (const Corner& c : view.corners) all[{i, view.t, c.id}] = c.uv;
    }
  }
  return all;
}

}  // namespace plumbline::test
