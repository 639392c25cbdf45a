// SPDX-License-Identifier: BSD-3-Clause
#include <optional>

#include <CLI/CLI.hpp>

#include "evaluate/cli/commands.h"
#include "evaluate/cli/options/result_options.h"
#include "evaluate/cli/options/shared_options.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/simulation/simulate_sequence.h"

namespace plumbline {
namespace {

struct SimulateSequenceOptions {
  OutputOptions output;
  std::optional<double> time_offset_ms;
  double exposure_ms = 4;
  SequenceOptions sequence;
};

void declareSimulateSequence(CLI::App& app, SimulateSequenceOptions& o) {
  SequenceOptions& s = o.sequence;
  s.simulation.duration_s = 40;
  o.output.declare(app, "Folder to write")->required();
  addWithDefault(app, "--rig", s.rig, "Rig: euroc (radtan), tumvi (equidistant), d435i");
  addWithDefault(app, "--seed", s.simulation.seed,
                 "Seed of motion, room, noise and motion capture: same seed, same bytes")
      ->check(seedFrom(0));
  addWithDefault(app, "--duration", s.simulation.duration_s, "Length [s]")
      ->check(numberWithin(1e-3, 1e5));
  addWithDefault(app, "--pace", s.flight.pace, "Factor on every frequency of the motion")
      ->check(numberWithin(0.01, 10));
  addWithDefault(app, "--first-rest", s.flight.first_rest_s,
                 "Rest before take-off [s] (0: starts in motion)")
      ->check(numberWithin(0, 1e4));
  addWithDefault(app, "--rests", s.flight.rests,
                 "Number of rests during the flight, 1.5 s each, as many as fit")
      ->check(numberWithin(0, 1000));
  addWithDefault(app, "--turns", s.flight.turns,
                 "Number of fast turns of 80 degrees in 0.9 s, as many as fit")
      ->check(numberWithin(0, 1000));
  app.add_option("--time-offset-ms", o.time_offset_ms,
                 "t_imu = t_cam + this [ms] (default: the rig's)")
      ->check(numberWithin(-1e6, 1e6));
  addWithDefault(app, "--tracks", s.tracks.tracks,
                 "Landmarks tracked at a time (not with --images)")
      ->check(numberWithin(1, 1e5));
  addWithDefault(app, "--track-sigma", s.tracks.sigma_px,
                 "Noise of tracks [px] (not with --images)")
      ->check(numberWithin(0, 100));
  addWithDefault(app, "--outliers", s.tracks.outlier_share,
                 "Fraction of outlier observations (not with --images)")
      ->check(numberWithin(0, 1));
  auto* images =
      app.add_flag("--images", s.images.rendered, "Render images instead of writing tracks");
  // They are of tracks, which images do not have.
  for (const char* of_tracks : {"--tracks", "--track-sigma", "--outliers"}) {
    images->excludes(app.get_option(of_tracks));
  }
  addWithDefault(app, "--exposure-ms", o.exposure_ms, "Exposure time of images (motion blur) [ms]")
      ->check(numberWithin(0, 1000))
      ->needs(images);
  addWithDefault(app, "--drop-outs", s.motion_capture.drop_outs,
                 "Number of gaps of the motion capture, 0.6 s each")
      ->check(numberWithin(0, 100));
  addWithDefault(app, "--threads", s.images.threads, "Rendering threads (0: all cores)")
      ->check(numberWithin(0, 1024));
}

int simulateSequenceFolder(SimulateSequenceOptions o) {
  if (o.time_offset_ms) o.sequence.simulation.time_offset_s = *o.time_offset_ms * 1e-3;
  o.sequence.images.exposure_s = o.exposure_ms * 1e-3;
  o.sequence.check();
  OutputFolder out(o.output.request("sequence"));
  ProgressBar bar;
  const SimulatedFlight flight = simulateSequence(o.sequence, out.path(), bar.sink());
  out.commit();
  bar.clear();
  say("Simulated a flight of {:g} s and {:.1f} m with rig {} (seed {}) in {}\n",
      o.sequence.simulation.duration_s, flight.length_m, o.sequence.rig, o.sequence.simulation.seed,
      o.output.out);
  const FlightOptions& asked = o.sequence.flight;
  const int rests = restsInFlight(asked, flight);
  // What does not fit is left out of the flight, and its truth states what was made.
  if (rests < asked.rests || flight.turns < asked.turns) {
    say("Only {} of {} rests and {} of {} turns fit into the flight; --duration makes it longer\n",
        rests, asked.rests, flight.turns, asked.turns);
  }
  // With the offset given, the truth, which is of the IMU's whole time, is cut to the images'.
  say("Run it: plumbline odometry {0} --calibration {0}/truth/camchain-imucam.yaml "
      "--truth {0}/truth/trajectory.csv --clock-offset {1:.9g} --association interpolate "
      "--out loop\n",
      o.output.out, flight.recording.truth.imu->timeOffset());
  say("Or against motion capture, which has its own clock, world frame and marker body: "
      "--clock-offset auto --hand-eye auto\n");
  return kDone;
}

}  // namespace

Command simulateSequenceCommand() {
  return {"sequence", "Simulate a flight through a room for odometry, with ground truth",
          "plumbline simulate sequence --duration 40 --images --out flight",
          withOptions(declareSimulateSequence, simulateSequenceFolder)};
}

}  // namespace plumbline
