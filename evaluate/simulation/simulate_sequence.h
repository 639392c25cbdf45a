// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "calibrator/fields/json_fields.h"
#include "calibrator/simulate/simulate_flight.h"
#include "calibrator/simulate/simulate_session.h"
#include "evaluate/results/progress.h"

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
