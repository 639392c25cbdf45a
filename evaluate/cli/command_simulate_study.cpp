// SPDX-License-Identifier: BSD-3-Clause
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "evaluate/cli/commands.h"
#include "evaluate/cli/options/option_values.h"
#include "evaluate/cli/options/result_options.h"
#include "evaluate/cli/options/shared_options.h"
#include "evaluate/cli/options/simulation_options.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/simulation/simulate_study.h"

namespace plumbline {
namespace {

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
      ->check(numberWithin(1, 1000));
  addWithDefault(app, "--duration", s.duration_s, "Approximate length of a free recording [s]")
      ->check(numberWithin(5, 600));
  addWithDefault(app, "--seed", s.seed,
                 "Seed of participants, motion and noise: same seed, same bytes")
      ->check(seedFrom(0));
  addWithDefault(app, "--held-out", s.held_out, "Held-out evaluation recordings")
      ->check(numberWithin(0, 100));
  addWithDefault(app, "--sequences", s.sequences, "Sequences with motion capture")
      ->check(numberWithin(0, 100));
  app.add_flag("--images", s.images, "Render images of the sequences, for odometry");
  addWithDefault(app, "--learning", s.learning,
                 "Learning: errors, reaction and time of the second session relative to the first "
                 "(1: none)")
      ->check(numberWithin(0.1, 1));
  declareSimulatedBoard(app, s.corner_sigma_px, s.board_bend_mm, o.guide_board);
  addWithDefault(app, "--threads", s.threads, "Threads (0: all cores)")
      ->check(numberWithin(0, 1024));
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

}  // namespace

Command simulateStudyCommand() {
  return {"study", "Simulate a user study, guided and unguided, with ground truth",
          "plumbline simulate study --participants 4 --duration 10 --out study",
          withOptions(declareSimulateStudy, simulateStudyFolder)};
}

}  // namespace plumbline
