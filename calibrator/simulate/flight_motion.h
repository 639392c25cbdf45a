// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "calibrator/base/transform.h"
#include "calibrator/simulate/motion.h"
#include "calibrator/simulate/rig.h"

namespace plumbline {

/// How a rig flies through a room.
struct FlightOptions {
  std::uint64_t seed = 1;           ///< of the motion
  double pace = 1;                  ///< multiplies every frequency; 1: about 0.8 m/s on the way
  double first_rest_s = 2;          ///< it stands until then; 0: it flies from the beginning
  int rests = 2;                    ///< further ones, spread over the flight, as many as fit
  double rest_s = 1.5;              ///< length of each
  double ramp_s = 1;                ///< in which it comes to a stand, and in which it starts
  int turns = 4;                    ///< fast ones about the vertical, likewise
  double turn_rad = 1.4;            ///< angle of each, either way
  double turn_s = 0.9;              ///< time of each; at most 1.875 turn_rad / turn_s fast
  Eigen::Vector3d room_m{8, 6, 3};  ///< size of the box; the frame F stands in the middle of its
                                    ///< floor, z up

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// A flight through a room, known in closed form. Position and heading (yaw, pitch, roll) are sums
/// of sinusoids q(s) of a warped time s(t), the yaw with quintic steps added, so that every
/// derivative is analytic and no integrator is involved:
///   dq/dt = q' ds/dt,  d2q/dt2 = q'' (ds/dt)^2 + q' d2s/dt2,
/// with ds/dt = 1 in flight, 0 in the rests, and quintic ramps between them (twice continuously
/// differentiable). Within 0.45 of the room's half width, 0.4 of its half height.
class FlightMotion {
 public:
  FlightMotion(const SimulatedRig& rig, double duration_s, const FlightOptions& options);

  /// State of the IMU frame S in F, t_s seconds after the start in the IMU's clock. Any t_s.
  MotionState at(double t_s) const;

  /// From and to, the rig not moving at all [s].
  const std::vector<std::pair<double, double>>& rests() const { return rests_; }
  /// Fast turns that fit into the flight.
  int turns() const { return static_cast<int>(turns_.size()); }

 private:
  struct Turn {
    double s = 0, angle = 0;  // begin in warped time, angle
  };

  ScalarMotion warp(double t_s) const;
  ScalarMotion yaw(double s) const;

  double ramp_s_, turn_s_;
  std::array<SumOfSinusoids, 6> channels_;  // x y z, yaw pitch roll
  std::vector<std::pair<double, double>> rests_;
  std::vector<Turn> turns_;
  Transform T_HS_;  // S in the heading frame H: x forward (camera 0's axis), z up
};

}  // namespace plumbline
