// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "calibrator/base/enum_words.h"
#include "calibrator/fields/fields.h"

namespace plumbline {

/// What a step does; each but kEstimate is a command of this program.
enum class StepKind {
  kDetect,  ///< corners of a recording that comes as images
  kBoard,   ///< the board's shape from the first held-out recording
  kCalibrate,
  kPerturb,
  kEvaluate,    ///< a calibration held fixed on a recording
  kCompare,     ///< another tool's result beside ours
  kEstimate,    ///< the study's own command makes a trajectory
  kTrajectory,  ///< a trajectory against its truth
  kOdometry,    ///< an odometry with a calibration, and its trajectories against their truth
  kReplay,
};
constexpr std::array<const char*, 10> enumWords(StepKind /*of*/) {
  return {"detect",  "board",    "calibrate",  "perturb",  "evaluate",
          "compare", "estimate", "trajectory", "odometry", "replay"};
}

/// A file or folder that a step reads, in the state that its key is of.
struct StepInput {
  std::string path, stamp;
};

void fields(auto& v, StepInput& i) {
  v("path", i.path, "absolute");
  v("stamp", i.stamp, "see stampOf()");
}

/// A step that must be done before.
struct StepNeed {
  std::string name, key;
};

void fields(auto& v, StepNeed& n) {
  v("name", n.name, "of the step");
  v("key", n.key, "of the result that is needed");
}

/// A piece of a night's work: one process, one result folder. Its key names what the result is of:
/// equal keys, equal results.
struct Step {
  std::string name;  ///< its folder below the night's, e.g. "sessions/p01_free/calibrate"
  StepKind kind = StepKind::kCalibrate;
  std::string session;  ///< whose result; empty of recordings that belong to none
  std::string part;     ///< recording, tool, "tool/recording" or "sequence/run"
  /// Of the command. "{out}" stands for the result's folder, "{threads}" for a number,
  /// "{result:STEP}" for that step's folder, "{shape:STEP}" for the board's shape that it found
  /// ("flat" if it found none).
  std::vector<std::string> words;
  std::vector<StepInput> inputs;
  std::vector<StepNeed> needs;
  std::string inputs_key;  ///< of inputs' contents and options
  std::string key;         ///< of these and the program
  std::string program;     ///< runningProgramHash() of who planned it
  double limit_s = 3600;
  int limit_mb = 8192;
  bool keep_records = false;  ///< otherwise records.sqlite is removed when its rows are read
};

void fields(auto& v, Step& s) {
  v("name", s.name, "its folder");
  v("kind", s.kind, "what it does");
  v("session", s.session, "whose result");
  v("part", s.part, "recording, tool, sequence");
  v("words", s.words, "of the command");
  v("inputs", s.inputs, "what it reads");
  v("needs", s.needs, "steps before");
  v("inputs_key", s.inputs_key, "of contents and options");
  v("key", s.key, "of these and the version");
  v("program", s.program, "hash of the program's file");
  v("limit_s", s.limit_s, "wall time");
  v("limit_mb", s.limit_mb, "address space");
  v("keep_records", s.keep_records, "whether records.sqlite stays");
}

/// Name of the plan in a study's folder.
inline constexpr const char* kPlanFile = "plan.jsonl";

/// The plan's text: a line (JSON) for each step.
std::string planText(const std::vector<Step>& steps);
/// The step of this name in a plan's file. Throws InputError where there is none.
Step readPlannedStep(const std::filesystem::path& plan, const std::string& name);

}  // namespace plumbline
