// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "calibrator/base/error.h"
#include "calibrator/base/time.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/options/result_options.h"
#include "evaluate/cli/options/shared_options.h"
#include "evaluate/cli/options/study_command_options.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/results/provenance.h"
#include "evaluate/study/engine/engines.h"
#include "evaluate/study/night.h"
#include "evaluate/study/run_step.h"

namespace plumbline {
namespace {

constexpr int kMostJobs = 4096;

struct StudyOptions {
  std::string study, out;
  std::string engine = "local";
  int jobs = 0;
  bool redo_failed = false;
  int recheck = 0;
  SlurmOptions slurm;
  int merge_round = 0;  // of a job that merges what the arrays did
  int merge_night = 0;
  JsonOption json;
  FailOnOption fail_on;
};

std::string timeText(double seconds) {
  // Rounded first: 59.7 s are a minute, and not 60 s.
  const int whole = static_cast<int>(std::lround(seconds));
  if (whole >= 3600) return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
  if (whole >= 60) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} s", whole);
}

/// A line that moves on a terminal; in a pipe a line for every tenth and every failure.
class NightTeller {
 public:
  NightSink sink() {
    return [this](const NightProgress& p) { tell(p); };
  }
  void clear() { bar_.clear(); }

 private:
  void tell(const NightProgress& p) {
    const double share = p.all > 0 ? static_cast<double>(p.done) / static_cast<double>(p.all) : 1;
    std::string where = fmt::format("{} of {} steps, {} failed", p.done, p.all, p.failed);
    if (p.seconds_left >= 0) where += fmt::format(", about {} left", timeText(p.seconds_left));
    if (!p.message.empty()) {
      bar_.clear();
      complain(fmt::format("{}: {}", p.step, p.message));
    }
    if (terminal_) {
      bar_.update(where, share);
      return;
    }
    const int tenth = static_cast<int>(10 * share);
    if (p.step.empty() || tenth == tenth_) return;
    tenth_ = tenth;
    complain(where);
  }

  // The share is of the whole night, whose own time left is in the line.
  ProgressBar bar_{false};
  bool terminal_ = isatty(STDERR_FILENO) != 0;
  int tenth_ = 0;
};

NightRequest nightRequest(const StudyOptions& o, const CLI::App& app) {
  if (o.study.empty()) {
    throw InputError(
        "the study's definition is missing; expected plumbline study STUDY.yaml --out FOLDER");
  }
  if (o.out.empty())
    throw InputError("--out is missing; expected the folder of the study's results");
  NightRequest request;
  request.study = o.study;
  request.out = o.out;
  request.checks = {checkCalibrateOptions, checkTrajectoryOptions};
  request.redo_failed = o.redo_failed;
  request.recheck = o.recheck;
  // Whatever the engine: the jobs of a night on Slurm do not hold its lock. The merging job is one.
  if (o.merge_round == 0) {
    request.refuse = refuseWhileUnderWay;
  } else {
    request.lock_wait_s = kSlurmLockWaitS;
    request.number = o.merge_night;
    request.refuse = [number = o.merge_night, since = o.slurm.since](const auto& folder) {
      refuseLateMerge(folder, number, since);
    };
  }
  auto given = givenOptions(app);
  // The definition is the input, which is stated by itself.
  std::erase_if(given, [](const auto& option) { return option.first == "study"; });
  request.provenance = makeProvenance("study", std::move(given));
  return request;
}

/// A regression against earlier nights has its own code, whatever --fail-on asks: a nightly script
/// tells the two apart.
int exitCodeOf(const StudyOptions& o, const NightOutcome& outcome) {
  return outcome.alarms.empty() ? o.fail_on.exitCode(outcome.level) : kRegression;
}

/// Of every night the same file: a study's own, which the next night replaces.
std::optional<OutputFile> reserveJson(const StudyOptions& o) {
  OutputOptions output;
  output.force = true;
  return o.json.reserve(output, {o.study}, o.out, kDocumentMark);
}

int finish(const PreparedNight& night, const StepResults& results, double seconds,
           const StudyOptions& o, std::optional<OutputFile>& json) {
  const NightOutcome outcome = finishNight(night, results, seconds);
  if (json) json->write(outcome.document);
  if (o.json.piped()) {
    writeDocument(outcome.document);
  } else {
    say("{}", nightSummary(outcome, o.out));
  }
  return exitCodeOf(o, outcome);
}

int runSlurm(const StudyOptions& o, PreparedNight night) {
  NightTeller teller;
  // This process is the job that follows a round of arrays, not the one that a person started.
  if (o.merge_round > 0) {
    return mergeSlurmRound(night, o.slurm, o.merge_round, [&](const NightOutcome& outcome) {
      say("{}", nightSummary(outcome, o.out));
      return exitCodeOf(o, outcome);
    });
  }
  const SlurmEnd end = runOnSlurm(std::move(night), o.slurm, teller.sink());
  teller.clear();
  say("{}", end.text);
  return end.exit_code;
}

int study(const StudyOptions& o, const CLI::App& app) {
  const Stopwatch watch;
  // Other engines return before there is a verdict.
  if (o.engine != "local" && (o.json.file || o.fail_on.level != "never")) {
    throw InputError("--json and --fail-on need --engine local; omit them");
  }
  const NightRequest request = nightRequest(o, app);
  std::optional<OutputFile> json = reserveJson(o);
  PreparedNight night = prepareNight(request);
  if (o.engine == "commands") {
    say("{}", commandList(night.folder, night.steps, o.study, o.out));
    return kDone;
  }
  if (o.engine == "slurm") return runSlurm(o, std::move(night));
  NightTeller teller;
  const StepResults results = runLocally(night.folder, night.steps, o.jobs, teller.sink());
  teller.clear();
  return finish(night, results, watch.seconds(), o, json);
}

/// A step that failed is a result of the night like any other: only what cannot be done at all
/// counts for the exit code.
int runSteps(const std::vector<std::string>& names,
             const std::function<void(const std::string& name)>& run) {
  int exit_code = kDone;
  for (const std::string& name : names) {
    try {
      run(name);
    } catch (const std::exception& error) {  // whatever it is, the others may do
      complain(error.what());
      exit_code = kBadInput;
    }
  }
  return exit_code;
}

std::function<int()> configureRunStep(CLI::App& app) {
  struct Options {
    std::string night;
    std::vector<std::string> names;
    int threads = 1;
  };
  auto o = std::make_shared<Options>();
  app.add_option("night", o->night, "The study's folder")->required();
  app.add_option("steps", o->names, "Names of steps of the study's plan")->required();
  app.add_option("--threads", o->threads, "Threads of each step")
      ->check(numberWithin(1, kMostJobs));
  return [o] {
    return runSteps(o->names, [&](const std::string& name) {
      const StepResult result = runStep(o->night, name, o->threads);
      if (!result.message.empty()) complain(fmt::format("{}: {}", name, result.message));
    });
  };
}

std::function<int()> configureRunPack(CLI::App& app) {
  struct Options {
    std::string night, packs;
    int index = 0;
  };
  auto o = std::make_shared<Options>();
  app.add_option("night", o->night, "The study's folder")->required();
  app.add_option("packs", o->packs, "File with one line of steps per task")->required();
  app.add_option("index", o->index, "Line of the task, from 0")->required();
  return [o] {
    // One thread a step: the array asks for no CPUs beyond the default of a task.
    return runSteps(stepsOfPack(o->packs, o->index),
                    [&](const std::string& name) { (void)runStep(o->night, name, 1); });
  };
}

std::function<int()> configureAccept(CLI::App& app) {
  struct Options {
    std::string night, session, figure, note;
  };
  auto o = std::make_shared<Options>();
  app.add_option("night", o->night, "The study's folder")->required();
  app.add_option("--session", o->session, "Session (default: all)");
  app.add_option("--figure", o->figure, "Figure, e.g. held_out_rmse_px (default: all)");
  app.add_option("--note", o->note, "Why the change is right; kept with the history");
  return [o] {
    for (const StudyAlarm& a : acceptChanges(o->night, o->session, o->figure, o->note)) {
      say("accepted: {} {}\n", a.metric, a.session);
    }
    return kDone;
  };
}

void declareStudy(CLI::App& app, StudyOptions& o) {
  // Not required() for CLI11, as the subcommands do without: nightRequest() asks for it and for
  // --out.
  app.add_option("study", o.study, "The study's definition: STUDY.yaml (required)");
  app.add_option("--out", o.out, "Folder of the results, the same every night (required)");
  addWithDefault(app, "--jobs", o.jobs, "Parallel steps on this machine (0: all cores)")
      ->check(numberWithin(0, kMostJobs));
  addWithDefault(app, "--engine", o.engine,
                 "local; slurm (job arrays); commands (prints them, for another scheduler)")
      ->check(CLI::IsMember({"local", "slurm", "commands"}));
  app.add_flag("--redo-failed", o.redo_failed, "Rerun failed steps even if nothing changed");
  addWithDefault(app, "--recheck", o.recheck,
                 "Rerun this many unchanged steps and compare; different ones every night")
      ->check(numberFrom(0));
  app.add_option("--slurm-throttle", o.slurm.throttle,
                 "Parallel tasks of a job array (0: no limit)")
      ->check(numberFrom(0));
  addWithDefault(app, "--slurm-pack", o.slurm.pack_s, "Expected work of one task [s]")
      ->check(positiveNumber());
  addWithDefault(app, "--slurm-rounds", o.slurm.rounds, "Times that a lost step is submitted")
      ->check(numberWithin(1, 20));
  app.add_option("--slurm-options", o.slurm.options,
                 "Additional options of sbatch, e.g. '--partition=short --account=lab'");
  o.json.declare(app);
  o.fail_on.declare(app);
  app.add_option("--merge-round", o.merge_round, "")->group("");
  app.add_option("--merge-since", o.slurm.since, "")->group("");
  app.add_option("--merge-night", o.merge_night, "")->group("");
}

void addPart(CLI::App& app, const char* name, const char* summary, const char* group,
             std::function<int()> (*configure)(CLI::App&),
             std::vector<std::pair<CLI::App*, std::function<int()>>>& parts) {
  // Without a group help does not show it: parts that only engines call.
  CLI::App* part = app.add_subcommand(name, summary)->group(group);
  parts.emplace_back(part, configure(*part));
}

}  // namespace

Command studyCommand() {
  return {"study",
          "Calibrate, evaluate and compare all sessions of a study; only what changed is run again",
          "plumbline study STUDY.yaml --out night\n  plumbline study accept night --figure ate_m",
          [](CLI::App& app) {
            auto options = std::make_shared<StudyOptions>();
            declareStudy(app, *options);
            std::vector<std::pair<CLI::App*, std::function<int()>>> parts;
            addPart(app, "accept", "Accept changes relative to earlier nights", "Subcommands",
                    configureAccept, parts);
            addPart(app, "run-step", "Run steps of a plan", "", configureRunStep, parts);
            addPart(app, "run-pack", "Run the steps of a task", "", configureRunPack, parts);
            return std::function<int()>([options, parts, &app] {
              for (const auto& [part, handler] : parts) {
                if (!part->parsed()) continue;
                refuseBefore(app, *part);
                return handler();
              }
              return study(*options, app);
            });
          }};
}

}  // namespace plumbline
