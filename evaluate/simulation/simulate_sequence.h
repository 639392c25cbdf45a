// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "calibrator/simulate/simulate_flight.h"
#include "calibrator/simulate/simulate_session.h"
#include "evaluate/results/progress.h"
#include "evaluate/simulation/motion_capture.h"

namespace plumbline {

/// What the cameras of a sequence recorded.
struct SequenceImages {
  bool rendered = false;      ///< images in place of tracks
  double exposure_s = 0.004;  ///< of an image, its stamp in the middle
  double noise_sigma = 2;     ///< of a pixel [grey levels]
  int threads = 0;            ///< that render; 0: all cores. The bytes do not depend on it.
};

/// A flight through a room, for odometry.
struct SequenceOptions {
  std::string rig = "euroc";
  /// Seed, duration, rates, time offset, IMU noise; what it says of a board is not looked at. Its
  /// seed is that of everything: motion, scene, noise and motion capture.
  SimulationOptions simulation;
  FlightOptions flight;
  TrackOptions tracks;
  SequenceImages images;
  MotionCaptureOptions motion_capture;

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// Rests after the first that fit into the flight: at most as many as were asked for.
int restsInFlight(const FlightOptions& options, const SimulatedFlight& flight);

/// Writes a sequence that `plumbline odometry` reads, with its truth beside it:
///   FOLDER/mav0/camN/{data.csv,sensor.yaml}     and tracks.csv or data/<stamp>.png
///   FOLDER/mav0/{imu0,mocap0}/data.csv, FOLDER/imu.yaml
///   FOLDER/truth/camchain-imucam.yaml           Kalibr's format
///   FOLDER/truth/trajectory.csv                 trajectoryCsv(): F of the room, the IMU's clock
///   FOLDER/truth/{landmarks,tracks}.csv         points in F; the point of each track
///   FOLDER/truth/truth.json                     options, calibration, rests, motion capture
/// FOLDER is there, one of its own (output.h). Returns what was flown.
SimulatedFlight simulateSequence(const SequenceOptions& options,
                                 const std::filesystem::path& folder, const ProgressSink& progress);

}  // namespace plumbline
