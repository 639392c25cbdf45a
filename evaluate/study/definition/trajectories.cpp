// SPDX-License-Identifier: BSD-3-Clause
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "evaluate/study/definition/values.h"

namespace plumbline::study_internal {
namespace {

constexpr int kMostRuns = 1000;

/// Of all {field} in a text, but for a shell's ${...}. Left in, one would stand in the command as
/// it is, or name files that are nowhere.
void refuseUnknownFields(const YamlMap& map, const std::string& key, const std::string& text,
                         const std::set<std::string>& fields) {
  for (std::size_t at = text.find('{'); at != std::string::npos; at = text.find('{', at + 1)) {
    const std::string field = text.substr(at + 1, text.find('}', at) - at - 1);
    const bool of_shell = at > 0 && text[at - 1] == '$';
    if (fields.count(field) > 0 || of_shell) continue;
    throw map.fault(key, {InputFault::kUnknownWord, fmt::format("unknown field {{{}}}", field),
                          fmt::format("{{{}}}", fmt::join(fields, "}, {"))});
  }
}

// Which odometry, and what only one that is not ours has.
void readOdometry(const YamlMap& how, StudyTrajectories& to) {
  to.odometry = how.text("odometry", "builtin, orbslam3, openvins or a runner's .yaml");
  const bool known = isOneOf(to.odometry, {"builtin", "orbslam3", "openvins"});
  if (!known) to.runner = fileOf(how, "odometry");
  // Refused rather than passed over: who gives them expects another system, or a spread of runs.
  for (const char* key : {"executable", "runs"}) {
    if (to.odometry != "builtin" || !how.has(key)) continue;
    throw how.fault(key,
                    {InputFault::kContradiction,
                     "the built-in odometry is part of this program, and its runs are identical",
                     "another odometry, or no such option"});
  }
  if (how.has("executable")) to.executable = fileOf(how, "executable");
  if (how.has("runs")) {
    to.runs = static_cast<int>(numberWithin(how, "runs", 1, kMostRuns, "runs of each, 1 or more"));
  }
}

/// How trajectories are written can only be stated for other systems: each step would be refused.
void refuseFormOfBuiltin(const YamlMap& how, const StudyTrajectories& trajectories) {
  if (trajectories.odometry != "builtin") return;
  for (const auto& [option, words] : trajectories.metrics) {
    if (!isOneOf(option, {"estimate-w-first", "estimate-inverted"})) continue;
    throw how.fault("metrics", {InputFault::kContradiction,
                                "--" + option +
                                    " is of what an external system writes, not of the built-in "
                                    "odometry",
                                "another odometry, or no such option"});
  }
}

void readSource(const YamlMap& how, const StudyDefinition& study, StudyTrajectories& to) {
  if (how.has("pattern")) {
    const std::string pattern = how.text("pattern", "files with {calibration} and {sequence}");
    refuseUnknownFields(how, "pattern", pattern, {"calibration", "sequence", "run"});
    // By its letters alone: no file has the pattern's name, so links cannot be followed.
    to.pattern = (study.file.parent_path() / pattern).lexically_normal().string();
  } else if (how.has("command")) {
    to.command = how.text("command", "a command with {calibration} and {out}");
    refuseUnknownFields(how, "command", to.command, {"calibration", "sequence", "out"});
  } else {
    readOdometry(how, to);
  }
}

}  // namespace

void readTrajectories(const YamlMap& map, const StudyOptionCheck& check, StudyDefinition& study) {
  if (!map.has("trajectories")) return;
  const YamlMap how =
      map.map("trajectories", "{odometry: builtin}, {pattern: FILES} or {command: COMMAND}");
  refuseUnknownKeys(how, {"pattern", "command", "odometry", "executable", "runs", "metrics"});
  const int sources =
      (how.has("pattern") ? 1 : 0) + (how.has("command") ? 1 : 0) + (how.has("odometry") ? 1 : 0);
  if (sources != 1 || study.sequences.empty()) {
    throw map.fault("trajectories", {InputFault::kContradiction,
                                     study.sequences.empty()
                                         ? "there are no sequences to estimate trajectories on"
                                         : "trajectories have a pattern, a command or an odometry",
                                     "sequences, and one of pattern, command and odometry"});
  }
  for (const char* key : {"executable", "runs"}) {
    if (!how.has(key) || how.has("odometry")) continue;
    throw how.fault(key, {InputFault::kContradiction, "applies to an odometry, but there is none",
                          "odometry: orbslam3, openvins or a runner's .yaml"});
  }
  readSource(how, study, study.trajectories);
  study.trajectories.metrics = optionsOf(how, "metrics", "plumbline evaluate trajectory", check);
  refuseFormOfBuiltin(how, study.trajectories);
}

}  // namespace plumbline::study_internal
