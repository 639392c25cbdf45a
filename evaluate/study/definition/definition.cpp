// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/study/definition/definition.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "datasets/files/yaml_map.h"
#include "evaluate/statistics/study_statistics.h"
#include "evaluate/study/definition/values.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

using namespace study_internal;

// Whoever writes more has taken another unit for milliseconds.
constexpr double kMostOffset = 10000;  // [ms]

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
    if (has_sessions) faults.attempt([&] { refuseSeenRecordings(map, study); });
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
