// SPDX-License-Identifier: BSD-3-Clause
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

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
      ->check(numberWithin(0, 1024));
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
