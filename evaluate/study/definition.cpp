// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/study/definition.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "datasets/files/yaml_map.h"
#include "evaluate/statistics/study_statistics.h"
#include "evaluate/study/definition_values.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

using namespace study_internal;

// Whoever writes more has taken another unit for milliseconds.
constexpr double kMostOffset = 10000;  // [ms]

// Of a tool's folder its calibration: the chain with an IMU before that of cameras alone.
fs::path calibrationIn(const YamlMap& map, const std::string& key) {
  const fs::path path = pathOf(map, key);
  if (fs::is_regular_file(path)) return path;
  std::vector<fs::path> chains;
  if (fs::is_directory(path)) {
    for (const auto& entry : fs::directory_iterator(path)) {
      const std::string name = entry.path().filename().string();
      const bool chain = name.find("camchain") != std::string::npos;
      if (chain && entry.path().extension() == ".yaml") chains.push_back(entry.path());
    }
  }
  // False before true: chains with an IMU first, then by name, whatever the folder's order.
  const auto rank = [](const fs::path& p) {
    const std::string name = p.filename().string();
    return std::pair(name.find("imucam") == std::string::npos, name);
  };
  std::sort(chains.begin(), chains.end(),
            [&](const fs::path& a, const fs::path& b) { return rank(a) < rank(b); });
  if (!chains.empty()) return chains.front();
  throw map.fault(key, {InputFault::kMissingFile,
                        path.string() + " is neither a calibration nor a folder with one",
                        "a calibration, or a folder of Kalibr's with *camchain*.yaml"});
}

/// A tool's name is part of its steps' names (compare_TOOL), so it may stand only once in a
/// session.
void readOthers(const YamlMap& map, SessionEntry& entry) {
  if (!map.has("other")) return;
  std::set<std::string> tools;
  for (const YamlMap& other : map.maps("other", "a list of {tool: kalibr, path: FOLDER}")) {
    refuseUnknownKeys(other, {"tool", "path"});
    const std::string tool = nameOf(other, "tool");
    if (!tools.insert(tool).second) {
      throw other.fault("tool",
                        {InputFault::kDuplicate, fmt::format("the tool '{}' is given twice", tool),
                         "each once", "use distinct names, e.g. kalibr and kalibr-splines"});
    }
    entry.others.emplace_back(tool, calibrationIn(other, "path"));
  }
}

void readStages(const YamlMap& map, StudySession& row) {
  if (!map.has("stages_s")) return;
  const YamlMap stages = map.map("stages_s", "seconds by stage, e.g. {camera: 30, camera_imu: 43}");
  double sum = 0;
  for (const std::string& name : stages.keys()) {
    row.stages.push_back({name, secondsOf(stages, name)});
    sum += row.stages.back().seconds;
  }
  // Stages may leave out pauses between them; they cannot be longer than the whole, but for the
  // rounding of what a person wrote down.
  if (row.capture_s && sum > *row.capture_s * 1.001 + 0.1) {
    throw map.fault("stages_s", {InputFault::kContradiction,
                                 fmt::format("the stages take {:g} s together, the capture {:g} s",
                                             sum, *row.capture_s),
                                 "stages_s that add up to capture_s at most"});
  }
}

/// A time that is ten times the limit is no slow participant: most likely milliseconds.
void refuseFarBeyond(const YamlMap& map, double seconds, double limit_s) {
  constexpr double kTimes = 10;
  if (seconds <= kTimes * limit_s) return;
  throw map.fault("capture_s",
                  {InputFault::kContradiction,
                   fmt::format("capture_s is {:g} s, {:.0f} times limit_s ({:g} s)", seconds,
                               seconds / limit_s, limit_s),
                   "seconds until the participant was done", "correct it, or raise limit_s"});
}

void readMethod(const YamlMap& map, const std::vector<std::string>& methods, StudySession& row) {
  row.method = map.text("method", "one of the study's methods");
  if (methods.empty()) return;  // they were refused
  if (std::find(methods.begin(), methods.end(), row.method) != methods.end()) return;
  throw map.fault("method",
                  {InputFault::kUnknownWord, fmt::format("unknown method '{}'", row.method),
                   fmt::format("one of {}", fmt::join(methods, ", "))});
}

/// The order of a participant's sessions, from which the crossover takes the period's effect.
void readPeriod(const YamlMap& map, StudySession& row) {
  row.period = map.integer("period", "1 for the participant's first session, 2 for the next");
  if (row.period >= 1) return;
  throw map.fault("period", {InputFault::kOutOfRange, fmt::format("period is {}", row.period),
                             "1 for the participant's first session"});
}

void readCapture(const YamlMap& map, double limit_s, StudySession& row) {
  if (map.has("capture_s")) {
    row.capture_s = secondsOf(map, "capture_s");
    refuseFarBeyond(map, *row.capture_s, limit_s);
  }
  readStages(map, row);
}

SessionEntry sessionOf(const YamlMap& map, const StudyDefinition& study) {
  SessionEntry entry;
  StudySession& row = entry.row;
  FaultList faults;
  faults.attempt([&] {
    refuseUnknownKeys(map, {"name", "participant", "method", "period", "path", "capture_s",
                            "finished", "stages_s", "other"});
  });
  faults.attempt([&] { row.name = nameOf(map, "name"); });
  faults.attempt([&] { row.participant = nameOf(map, "participant"); });
  faults.attempt([&] { readMethod(map, study.methods, row); });
  faults.attempt([&] { readPeriod(map, row); });
  faults.attempt([&] { entry.path = recordingOf(map, "path"); });
  faults.attempt([&] { readCapture(map, study.limit_s, row); });
  faults.attempt([&] { row.finished = flagOf(map, "finished", true); });
  faults.attempt([&] { readOthers(map, entry); });
  faults.raise();
  return entry;
}

void readSessions(const YamlMap& map, StudyDefinition& study) {
  Names names;
  FaultList faults;
  std::set<std::pair<std::string, int>> periods;
  for (const YamlMap& entry : map.maps("sessions", "a list of sessions")) {
    faults.attempt([&] {
      SessionEntry session = sessionOf(entry, study);
      // By itself, so that the period is looked at too where a name is given twice.
      faults.attempt([&] { names.add(entry, session.row.name); });
      if (!periods.insert({session.row.participant, session.row.period}).second) {
        throw entry.fault("period", {InputFault::kContradiction,
                                     fmt::format("participant {} has two sessions in period {}",
                                                 session.row.participant, session.row.period),
                                     "a different period for each session"});
      }
      study.sessions.push_back(std::move(session));
    });
  }
  faults.raise();
  if (study.sessions.empty()) {
    throw map.fault("sessions", {InputFault::kEmpty, "there are no sessions", "one or more"});
  }
}

// Every participant used every method: what is compared is compared within participants.
void refuseWithoutPair(const YamlMap& map, const StudyDefinition& study) {
  // Entries and sessions are parallel here: this runs only where every entry was read.
  std::map<std::string, std::set<std::string>> used;
  for (const SessionEntry& s : study.sessions) used[s.row.participant].insert(s.row.method);
  FaultList faults;
  std::size_t at = 0;
  for (const YamlMap& entry : map.maps("sessions", "")) {
    // Said at the participant's first session.
    const std::string& participant = study.sessions[at++].row.participant;
    for (const std::string& method : study.methods) {
      if (!used[participant].insert(method).second) continue;  // said once
      faults.attempt([&] {
        throw entry.fault(
            "participant",
            {InputFault::kContradiction,
             fmt::format("participant {} has no session with the method '{}'", participant, method),
             "a session of each participant with each method",
             "add it (finished: false where the participant gave up), or omit the participant"});
      });
    }
  }
  faults.raise();
}

/// Of a sequence (`with_truth`) only a folder is asked for: a study's own command may read another
/// layout than that of a session, which held-out recordings must have.
RecordingEntry recordingEntryOf(const YamlMap& entry, bool with_truth) {
  FaultList faults;
  RecordingEntry recording;
  faults.attempt([&] {
    if (with_truth) {
      refuseUnknownKeys(entry, {"name", "path", "truth"});
    } else {
      refuseUnknownKeys(entry, {"name", "path"});
    }
  });
  faults.attempt([&] { recording.name = nameOf(entry, "name"); });
  if (with_truth) {
    faults.attempt([&] {
      recording.path = pathOf(entry, "path");
      if (fs::is_directory(recording.path)) return;
      throw entry.fault("path",
                        {InputFault::kMissingFile, recording.path.string() + " is not a folder",
                         "the folder of a recording"});
    });
    faults.attempt([&] { recording.truth = fileOf(entry, "truth"); });
  } else {
    faults.attempt([&] { recording.path = recordingOf(entry, "path"); });
  }
  faults.raise();
  return recording;
}

std::vector<RecordingEntry> recordingsOf(const YamlMap& map, const std::string& key,
                                         bool with_truth) {
  std::vector<RecordingEntry> list;
  if (!map.has(key)) return list;
  Names names;
  FaultList faults;
  for (const YamlMap& entry : map.maps(key, "a list of recordings")) {
    faults.attempt([&] {
      RecordingEntry recording = recordingEntryOf(entry, with_truth);
      names.add(entry, recording.name);
      list.push_back(std::move(recording));
    });
  }
  faults.raise();
  return list;
}

void readMethods(const YamlMap& map, StudyDefinition& study) {
  if (!map.has("methods")) {
    throw map.fault("methods", {InputFault::kMissingKey, "the key 'methods' is missing",
                                "a list, the baseline first, e.g. [free, guided]", "add it"});
  }
  study.methods = wordsOf(map, "methods", "a list, the baseline first, e.g. [free, guided]");
}

/// A word of the enumeration, otherwise a file's name. Its word for files, FILE, stands for any of
/// them, so a file that is called so is read like the others.
void readTargetShape(const YamlMap& map, StudyDefinition& study) {
  const std::string word = map.textOr("target_shape", "");
  if (word.empty()) return;
  const auto known = enumFrom<StudyTargetShape>(word);
  study.target_shape = known.value_or(StudyTargetShape::kFile);
  if (!known || *known == StudyTargetShape::kFile) {
    study.target_shape = StudyTargetShape::kFile;
    study.target_shape_file = fileOf(map, "target_shape");
  }
  if (study.target_shape == StudyTargetShape::kOne && study.held_out.empty()) {
    throw map.fault(
        "target_shape",
        {InputFault::kContradiction,
         "one shape for all is estimated from the first held-out recording, but there is none",
         "held_out, or each, flat or a file"});
  }
}

void readPerturbations(const YamlMap& map, StudyDefinition& study) {
  if (!map.has("perturbations")) return;
  const YamlMap list = map.map("perturbations", "{offsets_ms: [100, 10, 1]}");
  refuseUnknownKeys(list, {"offsets_ms"});
  // Refused here, where the line is known: as a step it would fail once in every session.
  for (const auto& [option, words] : study.calibrate) {
    if (option == "no-imu") {
      throw map.fault("perturbations",
                      {InputFault::kContradiction,
                       "offsets are added to the IMU's stamps, but calibrate has no-imu", "",
                       "omit one of them"});
    }
  }
  study.offsets_ms = list.numbers("offsets_ms", "milliseconds, e.g. [100, 10, 1]");
  for (const double offset : study.offsets_ms) {
    if (std::abs(offset) <= kMostOffset) continue;
    throw list.fault("offsets_ms", {InputFault::kOutOfRange, fmt::format("{:g} ms", offset),
                                    fmt::format("milliseconds up to {:g}", kMostOffset)});
  }
}

void readLimits(const YamlMap& map, StudyDefinition& study) {
  if (!map.has("limits")) return;
  const YamlMap limits = map.map("limits", "{step_s: 3600, step_mb: 8192}");
  refuseUnknownKeys(limits, {"step_s", "step_mb"});
  if (limits.has("step_s")) {
    study.step_limit_s = numberWithin(limits, "step_s", 1, kMostSeconds, "seconds, 1 to 86400");
  }
  if (limits.has("step_mb")) {
    study.step_limit_mb =
        static_cast<int>(numberWithin(limits, "step_mb", 256, 1 << 24, "megabytes, 256 or more"));
  }
}

/// Only what is given replaces a default; the whole is checked at the end.
void readThresholds(const YamlMap& map, StudyDefinition& study) {
  if (!map.has("thresholds")) return;
  const YamlMap t = map.map("thresholds", "{regression_sigma: 4}");
  refuseUnknownKeys(t, {"regression_sigma", "regression_floor", "cusum", "cusum_slack", "window"});
  RegressionThresholds& to = study.thresholds;
  to.sigma = t.numberOr("regression_sigma", to.sigma);
  to.floor = t.numberOr("regression_floor", to.floor);
  to.cusum = t.numberOr("cusum", to.cusum);
  to.slack = t.numberOr("cusum_slack", to.slack);
  if (t.has("window")) to.window = t.integer("window", "a number of nights");
  try {
    to.check();
  } catch (const InputError& error) {
    throw map.fault("thresholds", {InputFault::kOutOfRange, error.what()});
  }
}

void readEndpoints(const YamlMap& map, StudyDefinition& study) {
  if (!map.has("endpoints")) return;
  study.endpoints = wordsOf(map, "endpoints", "figures of a session, e.g. [held_out_rmse_px]");
  // stages_s.NAME is an endpoint where any session has such a stage.
  std::vector<CaptureStage> stages;
  for (const SessionEntry& session : study.sessions) {
    stages.insert(stages.end(), session.row.stages.begin(), session.row.stages.end());
  }
  for (const std::string& name : study.endpoints) {
    if (isEndpoint(name, stages)) continue;
    throw map.fault("endpoints",
                    {InputFault::kUnknownWord, fmt::format("no figure is named '{}'", name),
                     "ate_m, or a session's figure with a unit, such as held_out_rmse_px, "
                     "capture_s or stages_s.camera (docs/records.md lists sessions[])"});
  }
}

}  // namespace

void RegressionThresholds::check() const {
  if (!(sigma > 0)) throw InputError("regression_sigma must be above 0");
  if (!(floor > 0 && floor < 1)) throw InputError("regression_floor is a share above 0, below 1");
  if (!(cusum > 0)) throw InputError("cusum must be above 0");
  if (!(slack >= 0)) throw InputError("cusum_slack must not be negative");
  if (window < 1) throw InputError("the window must be of 1 night or more");
}

StudyDefinition readStudy(const std::string& path, const StudyOptionChecks& checks) {
  const YamlMap map = YamlMap::load(path, "a study's definition: study, methods, sessions, ...");
  StudyDefinition study;
  study.file = fs::weakly_canonical(fs::absolute(path));
  FaultList faults;
  faults.attempt([&] {
    refuseUnknownKeys(
        map, {"study", "rig", "target", "target_shape", "calibrate", "limit_s", "methods",
              "sessions", "held_out", "sequences", "trajectories", "perturbations", "endpoints",
              "thresholds", "limits", "cross", "replay", "keep_records"});
  });
  // Methods and limit_s come before the sessions, which are held against them.
  faults.attempt([&] { study.name = map.text("study", "the study's name"); });
  faults.attempt([&] {
    if (map.has("rig")) study.rig = map.text("rig", "the rig's name");
  });
  faults.attempt([&] {
    if (map.has("target")) study.target = fileOf(map, "target");
  });
  faults.attempt([&] {
    if (!map.has("limit_s")) return;
    study.limit_s = secondsOf(map, "limit_s");
    if (study.limit_s > 0) return;
    throw map.fault("limit_s", {InputFault::kOutOfRange, "limit_s is 0", "seconds above 0"});
  });
  const bool has_methods = faults.attempt([&] { readMethods(map, study); });
  const bool has_sessions = faults.attempt([&] { readSessions(map, study); });
  if (has_methods && has_sessions) faults.attempt([&] { refuseWithoutPair(map, study); });
  // What rests on a list that was refused is not judged by what is left of it.
  if (faults.attempt([&] { study.held_out = recordingsOf(map, "held_out", false); })) {
    faults.attempt([&] { readTargetShape(map, study); });
  }
  faults.attempt([&] {
    study.calibrate =
        optionsOf(map, "calibrate", "plumbline calibrate", checks.calibrate, {"cameras", "imu"});
  });
  if (faults.attempt([&] { study.sequences = recordingsOf(map, "sequences", true); })) {
    faults.attempt([&] { readTrajectories(map, checks.trajectory, study); });
  }
  faults.attempt([&] { readPerturbations(map, study); });
  if (has_sessions) faults.attempt([&] { readEndpoints(map, study); });
  faults.attempt([&] { readLimits(map, study); });
  faults.attempt([&] { readThresholds(map, study); });
  faults.attempt([&] { study.cross = flagOf(map, "cross", false); });
  faults.attempt([&] { study.replay = flagOf(map, "replay", false); });
  faults.attempt([&] { study.keep_records = flagOf(map, "keep_records", false); });
  faults.raise();
  return study;
}

}  // namespace plumbline
