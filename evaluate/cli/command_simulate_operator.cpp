// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "datasets/session/target.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/options/option_values.h"
#include "evaluate/cli/options/result_options.h"
#include "evaluate/cli/options/shared_options.h"
#include "evaluate/cli/options/simulation_options.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/results/provenance.h"
#include "evaluate/simulation/simulate_operator.h"

namespace plumbline {
namespace {

/// A figure of the skill on the command line, in the unit of its option.
struct SkillFigure {
  const char* option;
  double OperatorSkill::*figure;
  double unit;
  double least, most;  ///< what OperatorSkill::check() takes, of radians to six digits
  const char* text;
};

constexpr SkillFigure kFigures[] = {
    {"--reaction-s", &OperatorSkill::reaction_s, 1, 0, 10, "Reaction time [s]"},
    {"--speed", &OperatorSkill::speed_m_s, 1, 0.001, 10, "Speed of the hand [m/s]"},
    {"--turn", &OperatorSkill::turn_rad_s, kDegree, 0.0572958, 572.957,
     "Turning speed of the hand [deg/s]"},
    {"--position-error-mm", &OperatorSkill::position_error_m, 1e-3, 0, 1000,
     "Initial position error at a suggested view, std [mm]"},
    {"--angle-error", &OperatorSkill::angle_error_rad, kDegree, 0, 57.2957,
     "Initial rotation error at a suggested view, std [deg]"},
    {"--correction-s", &OperatorSkill::correction_s, 1, 0.001, 100,
     "Time constant with which errors are corrected [s]"},
    {"--overshoot", &OperatorSkill::overshoot, 1, 0, 1,
     "Overshoot of a suggested view, as a fraction of the path"},
    {"--tremor-mm", &OperatorSkill::tremor_m, 1e-3, 0, 100,
     "Tremor of the hand: position, std [mm]"},
    {"--tremor", &OperatorSkill::tremor_rad, kDegree, 0, 5.72957,
     "Tremor of the hand: rotation, std [deg]"},
    {"--off-axis", &OperatorSkill::off_axis_rad, kDegree, 1.14592, 180,
     "Largest angle between the board's centre and the optical axis of camera 0 [deg]"},
    {"--fatigue", &OperatorSkill::fatigue_per_min, 1, 0, 10,
     "Fatigue: growth of tremor and of slowness per minute"},
    {"--compliance", &OperatorSkill::compliance, 1, 0, 1,
     "Fraction of the suggestions that are followed"},
    {"--patience-s", &OperatorSkill::patience_s, 1, 0, 1e5,
     "Time after which the operator gives up [s]"},
};

/// Options of the guide that `replay` has under the same names.
constexpr const char* kGuideOptions[] = {"--criterion",          "--patience",
                                         "--reached-px",         "--reached-s",
                                         "--stop-projection-px", "--stop-reprojection-px",
                                         "--trajectory-s",       "--trajectory-amplitude",
                                         "--trajectory-roll",    "--trajectory-held-s",
                                         "--first-trajectory",   "--operator-speed"};

struct SimulateOperatorOptions {
  OutputOptions output;
  std::string skill = "practised";
  std::string method = toString(OperatorMethod::kGuided);
  std::string criterion = toString(ViewCriterion::kMutualInformation);
  TrajectoryWords trajectories;
  std::string guide_board = toString(GuideBoard::kMeasured);
  std::array<std::optional<double>, std::size(kFigures)> figures;
  OperatorSimulationOptions simulation;
};

void declareSimulateOperator(CLI::App& app, SimulateOperatorOptions& o) {
  auto& s = o.simulation;
  o.output.declare(app, "Folder to write")->required();
  addWithDefault(app, "--rig", s.rig, "Rig: euroc (radtan), tumvi (equidistant), d435i");
  addWithDefault(app, "--method", o.method,
                 "guided; free (views around the board, then faster motion); dance (back and forth "
                 "along and about each axis, then faster)")
      ->check(CLI::IsMember({"guided", "free", "dance"}));
  addWithDefault(app, "--criterion", o.criterion, "Criterion of the guide: mi or predicted-error");
  addWithDefault(app, "--skill", o.skill,
                 "expert, practised, novice, or a clumsiness from 0 to 1; the options below set "
                 "single values");
  for (std::size_t i = 0; i < std::size(kFigures); ++i) {
    const SkillFigure& figure = kFigures[i];
    app.add_option(figure.option, o.figures[i], figure.text)
        ->check(numberWithin(figure.least, figure.most));
  }
  declareAskingAndStops(app, s.guide, o.trajectories);
  addWithDefault(app, "--duration", s.duration_s,
                 "Length of an unguided recording, and limit of a guided one [s]")
      ->check(numberWithin(5, 3600));
  addWithDefault(app, "--trajectories", s.trajectories,
                 "Guided: end after this many trajectories, if the guide has not finished before "
                 "(0: no limit)")
      ->check(numberWithin(0, 1000));
  addWithDefault(app, "--seed", s.seed, "Seed of operator and noise: same seed, same bytes")
      ->check(seedFrom(0));
  declareSimulatedBoard(app, s.corner_sigma_px, s.board_bend_mm, o.guide_board);
  app.add_flag("--judge", s.judge, "Also find when the recording was sufficient");
}

/// Without a guide they would change nothing that is recorded.
void refuseGuideOptions(const std::string& method, const CLI::App& app) {
  const auto refuse = [&](const char* option) {
    if (app.count(option) == 0) return;
    throw InputError(fmt::format(
        "{} is of the guide, which --method {} does without; omit it, or give --method guided",
        option, method));
  };
  refuse("--trajectories");
  for (const char* option : kGuideOptions) refuse(option);
}

/// The words are places on the scale of clumsiness.
OperatorSkill skillFrom(const std::string& word) {
  if (word == "expert") return personSkill(0);
  if (word == "practised") return personSkill(0.5);
  if (word == "novice") return personSkill(1);
  const auto clumsiness = finiteNumber(word);
  if (!clumsiness || *clumsiness < 0 || *clumsiness > 1) {
    throw InputError(fmt::format(
        "--skill {}: expected expert, practised, novice, or a clumsiness from 0 to 1", word));
  }
  return personSkill(*clumsiness);
}

OperatorSimulationOptions simulationOf(const SimulateOperatorOptions& o, const CLI::App& app) {
  OperatorSimulationOptions s = o.simulation;
  // Never empty: CLI11 has let through known words only.
  s.method = *enumFrom<OperatorMethod>(o.method);
  if (s.method != OperatorMethod::kGuided) refuseGuideOptions(o.method, app);
  s.guide_board = *enumFrom<GuideBoard>(o.guide_board);
  s.guide.views.criterion = s.guide.trajectories.criterion =
      enumValue<ViewCriterion>("--criterion", o.criterion);
  o.trajectories.writeTo(s.guide.trajectories);
  s.skill = skillFrom(o.skill);
  for (std::size_t i = 0; i < std::size(kFigures); ++i) {
    // After the skill's word, of which they change single values.
    if (o.figures[i]) s.skill.*kFigures[i].figure = kFigures[i].unit * *o.figures[i];
  }
  s.check();
  return s;
}

/// The replay of what was recorded, by a guide that knows what the recording's did.
std::string replayOf(const SimulateOperatorOptions& o, const OperatorSimulationOptions& simulation,
                     const CLI::App& app) {
  std::vector<std::string> words{"plumbline", "replay", o.output.out};
  if (simulation.board_bend_mm != 0 && simulation.guide_board == GuideBoard::kMeasured) {
    const std::string shape = std::string("truth/") + kTargetShapeFile;
    words.insert(words.end(),
                 {"--target-shape", (std::filesystem::path(o.output.out) / shape).string()});
  }
  for (const char* option : kGuideOptions) {
    if (app.count(option) == 0) continue;
    words.insert(words.end(), {option, app.get_option(option)->results().back()});
  }
  words.insert(words.end(), {"--out", "replay"});
  return shellWords(words);
}

int simulateOperatorFolder(const SimulateOperatorOptions& o, const CLI::App& app) {
  const OperatorSimulationOptions simulation = simulationOf(o, app);
  OutputFolder out(o.output.request("session"));
  const OperatorSimulationSummary made = simulateOperator(simulation, out.path());
  out.commit();
  say("Simulated an operator ({}, {}, seed {}) in {}: {:.1f} s for the cameras, {:.1f} s for the "
      "IMU, {}\n",
      o.skill, o.method, simulation.seed, o.output.out, made.camera_s, made.camera_imu_s,
      made.finished ? "finished" : "not finished (gave up, or time limit reached)");
  if (simulation.method == OperatorMethod::kGuided) {
    say("{} of {} suggestions reached{}\n", made.reached, made.suggestions,
        made.open ? "; one was open at the end" : "");
  }
  say("{}", judgementText(made));
  say("Run it: {}; the truth is in {}/truth\n", replayOf(o, simulation, app), o.output.out);
  return kDone;
}

}  // namespace

Command simulateOperatorCommand() {
  return {"operator", "Simulate an operator's recording, guided or unguided, with ground truth",
          "plumbline simulate operator --skill novice --out session",
          withOptions(declareSimulateOperator, simulateOperatorFolder)};
}

}  // namespace plumbline
