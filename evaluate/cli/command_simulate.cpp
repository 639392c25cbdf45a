// SPDX-License-Identifier: BSD-3-Clause
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/simulate/rig.h"
#include "calibrator/simulate/simulate_session.h"
#include "datasets/session/session_writer.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/options/option_values.h"
#include "evaluate/cli/options/result_options.h"
#include "evaluate/cli/options/shared_options.h"
#include "evaluate/cli/options/simulation_options.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/simulation/simulate_sequence.h"
#include "evaluate/simulation/simulate_study.h"

namespace plumbline {
namespace {

struct SimulateOptions {
  OutputOptions output;
  std::string rig = "euroc";
  std::string motion = "full";
  bool images = false;
  int threads = 0;
  std::optional<double> time_offset_ms;
  std::vector<std::string> faults;
  std::optional<std::string> target_shape;
  SimulationOptions simulation;
};

void declareSimulate(CLI::App& app, SimulateOptions& o) {
  auto& s = o.simulation;
  // Not required() for CLI11: --fault list and the subcommands do without.
  o.output.declare(app, "Folder to write (required, except with --fault list)");
  addWithDefault(app, "--rig", o.rig, "Rig: euroc (radtan), tumvi (equidistant), d435i");
  addWithDefault(
      app, "--motion", o.motion,
      "Motion of the rig: full, or a degenerate one under which parameters are unobservable: "
      "pure-rotation, single-axis, planar (both about y of the IMU), static, fronto-parallel");
  addWithDefault(app, "--seed", s.seed, "Seed of motion and noise: same seed, same bytes")
      ->check(seedFrom(0));
  app.add_flag("--images", o.images, "Render images instead of writing corners");
  addWithDefault(app, "--duration", s.duration_s, "Length [s]")->check(numberWithin(1e-3, 1e5));
  app.add_option("--camera-rate", s.camera_rate_hz, "Camera rate [Hz] (default: the rig's)")
      ->check(numberWithin(1e-3, 1e5));
  app.add_option("--imu-rate", s.imu_rate_hz, "IMU rate [Hz] (default: the rig's)")
      ->check(numberWithin(1e-3, 1e5));
  app.add_option("--time-offset-ms", o.time_offset_ms,
                 "t_imu = t_cam + this [ms] (default: the rig's)")
      ->check(numberWithin(-1e6, 1e6));
  addWithDefault(app, "--corner-sigma", s.corner_sigma_px,
                 "Noise of corners [px] (not with --images)")
      ->check(numberWithin(0, 1000));
  addWithDefault(app, "--outliers", s.outlier_fraction,
                 "Fraction of outlier corners (not with --images)")
      ->check(numberWithin(0, 1));
  app.add_option("--fault", o.faults,
                 "Inject a fault, e.g. gyro-delay=5ms; repeatable; list: prints all faults")
      ->allow_extra_args(false);
  app.add_option("--target-shape", o.target_shape,
                 "True shape of the board, which target.yaml does not state: terms of " +
                     targetShapeExample());
  // They are of corners, which images do not have.
  for (const char* of_corners : {"--corner-sigma", "--outliers"}) {
    app.get_option("--images")->excludes(app.get_option(of_corners));
  }
  addWithDefault(app, "--threads", o.threads, "Rendering threads (0: all cores)")
      ->check(CLI::Range(0, 1024));
}

int simulate(SimulateOptions o) {
  // Ahead of all checks, since `list` stands for a question and needs no --out.
  for (const std::string& spec : o.faults) {
    if (spec == "list") {
      say("{}", faultList());
      return kDone;
    }
    o.simulation.faults.push_back(faultFrom(spec));
  }
  if (o.output.out.empty()) throw InputError("--out is required; name the folder to write");
  if (o.target_shape) {
    o.simulation.target.shape = targetShapeFromWords(*o.target_shape, o.simulation.target);
  }
  if (o.images) checkRendered(o.simulation.faults);
  // The last term is tag_edge: where a detector puts corners, not where they are printed.
  if (o.images && o.simulation.target.shape.terms[kTargetTerms - 1] != 0) {
    throw InputError(
        "--target-shape tag-edge is an error of a detector, which --images cannot show; omit one");
  }
  // One seed for motion and noise, whose random numbers are of different streams.
  o.simulation.trajectory.seed = o.simulation.seed;
  o.simulation.trajectory.kind = enumValue<MotionKind>("--motion", o.motion);
  if (o.time_offset_ms) o.simulation.time_offset_s = *o.time_offset_ms * 1e-3;
  const SimulatedRig rig = simulatedRig(o.rig);
  OutputFolder out(o.output.request("session"));
  const SimulatedSession simulated = simulateSession(rig, o.simulation);
  ProgressBar bar;
  SimulatedSessionFormat format;
  format.views = o.images ? ViewFormat::kImages : ViewFormat::kCorners;
  format.render.seed = o.simulation.seed;
  format.threads = o.threads;
  format.progress = [&bar](std::size_t done, std::size_t all) {
    bar.update("rendering", static_cast<double>(done) / static_cast<double>(all));
  };
  writeSimulatedSession(simulated, o.simulation, out.path(), format);
  out.commit();
  bar.clear();
  say("Simulated {:g} s of rig {} (seed {}) in {}\n", o.simulation.duration_s, o.rig,
      o.simulation.seed, o.output.out);
  say("The truth is in {}/truth\n", o.output.out);
  return kDone;
}

struct SimulateStudyOptions {
  OutputOptions output;
  std::string guide_board = toString(GuideBoard::kMeasured);
  StudySimulationOptions study;
};

void declareSimulateStudy(CLI::App& app, SimulateStudyOptions& o) {
  auto& s = o.study;
  o.output.declare(app, "Folder to write")->required();
  addWithDefault(app, "--participants", s.participants,
                 "Number of participants, each with both methods")
      ->check(CLI::Range(1, 1000));
  addWithDefault(app, "--duration", s.duration_s, "Approximate length of a free recording [s]")
      ->check(numberWithin(5, 600));
  addWithDefault(app, "--seed", s.seed,
                 "Seed of participants, motion and noise: same seed, same bytes")
      ->check(seedFrom(0));
  addWithDefault(app, "--held-out", s.held_out, "Held-out evaluation recordings")
      ->check(CLI::Range(0, 100));
  addWithDefault(app, "--sequences", s.sequences, "Sequences with motion capture")
      ->check(CLI::Range(0, 100));
  app.add_flag("--images", s.images, "Render images of the sequences, for odometry");
  addWithDefault(app, "--learning", s.learning,
                 "Learning: errors, reaction and time of the second session relative to the first "
                 "(1: none)")
      ->check(numberWithin(0.1, 1));
  declareSimulatedBoard(app, s.corner_sigma_px, s.board_bend_mm, o.guide_board);
  addWithDefault(app, "--threads", s.threads, "Threads (0: all cores)")->check(CLI::Range(0, 1024));
}

std::string timeOf(const std::optional<double>& median_s) {
  return median_s ? fmt::format("{:.1f} s", *median_s) : "none finished";
}

int simulateStudyFolder(SimulateStudyOptions o) {
  // Never empty: CLI11 has let through known words only.
  o.study.guide_board = *enumFrom<GuideBoard>(o.guide_board);
  o.study.check();
  OutputFolder out(o.output.request("simulated study"));
  ProgressBar bar;
  const StudySimulationSummary made = simulateStudy(o.study, out.path(), bar.sink());
  out.commit();
  bar.clear();
  say("Simulated {} sessions of {} participants (seed {}) in {}\n", made.sessions,
      o.study.participants, o.study.seed, o.output.out);
  say("Median time: free {}, guided {}; {} gave up; {} of {} suggestions reached\n",
      timeOf(made.free_s), timeOf(made.guided_s), made.gave_up, made.reached, made.suggestions);
  say("Run it: plumbline study {0}/STUDY.yaml --out NIGHT; the truth is in {0}/truth.json\n",
      o.output.out);
  return kDone;
}

Command simulateStudyCommand() {
  return {"study", "Simulate a user study, guided and unguided, with ground truth",
          "plumbline simulate study --participants 4 --duration 10 --out study",
          withOptions(declareSimulateStudy, simulateStudyFolder)};
}

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
      ->check(CLI::Range(0, 1024));
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
      "--truth {0}/truth/trajectory.csv --clock-offset {1:.9g} --out loop\n",
      o.output.out, flight.recording.truth.imu->timeOffset());
  say("Or against motion capture, which has its own clock, world frame and marker body: "
      "--clock-offset auto --hand-eye auto\n");
  return kDone;
}

Command simulateSequenceCommand() {
  return {"sequence", "Simulate a flight through a room for odometry, with ground truth",
          "plumbline simulate sequence --duration 40 --images --out flight",
          withOptions(declareSimulateSequence, simulateSequenceFolder)};
}

}  // namespace

Command simulateCommand() {
  return {"simulate", "Simulate a recording with ground truth",
          "plumbline simulate --out session --rig euroc --seed 7 --images", [](CLI::App& app) {
            auto options = std::make_shared<SimulateOptions>();
            declareSimulate(app, *options);
            app.require_subcommand(0, 1);
            const auto chosen = addCommands(app, {simulateStudyCommand(), simulateSequenceCommand(),
                                                  simulateOperatorCommand()});
            return std::function<int()>([options, chosen, &app] {
              if (app.get_subcommands().empty()) return simulate(*options);
              refuseBefore(app, *app.get_subcommands().front());
              return chosen();
            });
          }};
}

}  // namespace plumbline
