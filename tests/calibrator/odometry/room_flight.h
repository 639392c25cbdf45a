// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "calibrator/base/session.h"
#include "calibrator/odometry/odometry.h"
#include "calibrator/odometry/rig_model.h"
#include "calibrator/simulate/simulate_flight.h"

namespace plumbline {

struct RoomFlightOptions {
  std::uint64_t seed = 1;
  double duration_s = 30;
  std::optional<double> camera_rate_hz;  ///< the rig's unless given
  double rest_s = 0;                     ///< stands still before it flies
  double pixel_sigma = 0.5;              ///< of a track's coordinates [px]
  bool imu_noise = true;
  int turns = 4;             ///< fast ones
  int tracks = 150;          ///< followed at a time
  double outlier_share = 0;  ///< of sightings that lie anywhere
};

/// A simulated flight as the odometry takes it.
struct RoomFlight {
  RoomFlight(const SimulatedRig& rig, const RoomFlightOptions& options);

  std::vector<FrameTracks> frames;  ///< all cameras, camera clock
  std::vector<ImuSample> samples;
  std::vector<Transform> truth;  ///< T_FS, one per frame
  double length_m = 0;
};

/// Of 10 s; without noise of the IMU where tracks have none.
RoomFlightOptions flightOfTenSeconds(double pixel_sigma);

/// The odometry flown to the end by the first `cameras` of the calibration.
OdometryResult flownBy(const RoomFlight& flight, const Calibration& calibration,
                       const OdometryOptions& options = {}, int cameras = 2);

/// RMSE of positions after the best rigid motion (SE3) of the estimate onto the truth.
double alignedRmse(const std::vector<Eigen::Vector3d>& estimate,
                   const std::vector<Eigen::Vector3d>& truth);

}  // namespace plumbline
