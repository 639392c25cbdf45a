// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "calibrator/base/session.h"
#include "calibrator/odometry/tracks.h"
#include "calibrator/simulate/motion.h"
#include "calibrator/simulate/rig.h"

namespace plumbline {

struct RoomFlightOptions {
  std::uint64_t seed = 1;
  double duration_s = 30;
  double rest_s = 0;         ///< stands still before it flies
  double pace = 1;           ///< multiplies all frequencies
  double pixel_sigma = 0.5;  ///< of a track's coordinates [px]
  bool imu_noise = true;
  int landmarks = 800;       ///< on the walls of a room of 8 x 6 x 3 m
  int tracks = 120;          ///< seen by a camera at most
  double outlier_share = 0;  ///< of sightings that lie anywhere
};

/// A flight in closed form through a room with points on its walls, and what a rig's sensors would
/// say of it. World: z up.
class RoomFlight {
 public:
  RoomFlight(const SimulatedRig& rig, const RoomFlightOptions& options);

  /// Of the IMU frame S in the room, t_s after the start in the IMU's clock.
  MotionState at(double t_s) const;
  double length() const;  ///< of the way [m]

  std::vector<FrameTracks> frames;  ///< all cameras, camera clock
  std::vector<ImuSample> samples;
  std::vector<MotionState> truth;  ///< one per frame
  ImuBias bias;                    ///< at the start

 private:
  ScalarMotion warped(const SumOfSinusoids& channel, double t_s) const;
  void makeImu(const SimulatedRig& rig);
  void makeFrames(const SimulatedRig& rig);

  RoomFlightOptions options_;
  std::vector<SumOfSinusoids> channels_;  // x y z, yaw pitch roll
};

/// RMSE of positions after the best rigid motion (SE3) of the estimate onto the truth.
double alignedRmse(const std::vector<Eigen::Vector3d>& estimate,
                   const std::vector<Eigen::Vector3d>& truth);

}  // namespace plumbline
