// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrator/simulate/flight_motion.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {

/// What the cameras see of a room's landmarks.
struct TrackOptions {
  int landmarks = 1500;   ///< points on the walls, floor and ceiling
  int tracks = 150;       ///< followed at a time, at most
  double sigma_px = 0.5;  ///< standard deviation of u and of v
  double life_s = 6;      ///< mean; a point that is lost comes again as another track. 0: as long
                          ///< as camera 0 sees it
  double outlier_share = 0;    ///< of sightings that lie anywhere in the image
  double least_depth_m = 0.2;  ///< points nearer than this are not seen

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// A flight through a room whose truth is known.
struct SimulatedFlight {
  /// Its frame F is the room's. The views hold tracks: `id` is the track's, the same in all frames
  /// and cameras that see its point, never used again.
  SimulatedSession recording;
  std::vector<std::pair<double, double>> rests;  ///< [s], as FlightMotion::rests()
  int turns = 0;                                 ///< as FlightMotion::turns()
  std::vector<Eigen::Vector3d> landmarks;        ///< in F [m]
  std::vector<int> landmark_of = {};             ///< of each track id
  double length_m = 0;                           ///< of the way, first to last frame
};

/// Simulates what a rig's sensors say of a flight: tracks
///   uv = project(T_CiF p_F) + n, n white,
/// at the exposure's true time, and the IMU as simulateSession() has it. A track begins in camera
/// 0, lives as long as that sees its point, or is lost at random; other cameras see it where they
/// can. All cameras expose at the nominal stamps; the board, its corners, dropped frames and jitter
/// of `simulation` are not made. Same arguments, same values; motion, landmarks, tracks and IMU
/// have random numbers of their own. Throws InputError for options out of range.
SimulatedFlight simulateFlight(const SimulatedRig& rig, const SimulationOptions& simulation,
                               const FlightOptions& flight, const TrackOptions& tracks);

}  // namespace plumbline
