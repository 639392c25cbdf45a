// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "evaluate/study/definition/values.h"

namespace plumbline::study_internal {
namespace {

namespace fs = std::filesystem;

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
  std::ranges::sort(chains, {}, rank);
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
  if (std::ranges::find(methods, row.method) != methods.end()) return;
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

}  // namespace

void readSessions(const YamlMap& map, StudyDefinition& study) {
  Names names;
  std::map<std::filesystem::path, std::string> recordings;
  FaultList faults;
  std::set<std::pair<std::string, int>> periods;
  for (const YamlMap& entry : map.maps("sessions", "a list of sessions")) {
    faults.attempt([&] {
      SessionEntry session = sessionOf(entry, study);
      // By itself, so that the period is looked at too where a name is given twice.
      faults.attempt([&] { names.add(entry, session.row.name); });
      const auto [first, fresh] = recordings.emplace(session.path, session.row.name);
      if (!fresh) {
        throw entry.fault("path", {InputFault::kDuplicate,
                                   "the recording is that of session " + first->second + ", too",
                                   "a recording of its own for each session"});
      }
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

void refuseSeenRecordings(const YamlMap& map, const StudyDefinition& study) {
  if (study.held_out.empty()) return;
  FaultList faults;
  std::size_t at = 0;
  for (const YamlMap& entry : map.maps("held_out", "")) {
    const auto seen =
        std::ranges::find(study.sessions, study.held_out[at++].path, &SessionEntry::path);
    if (seen == study.sessions.end()) continue;
    faults.attempt([&] {
      throw entry.fault("path", {InputFault::kContradiction,
                                 "the recording is that of session " + seen->row.name +
                                     ", whose calibration would be scored on its own corners",
                                 "recordings that no session is calibrated from"});
    });
  }
  faults.raise();
}

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

}  // namespace plumbline::study_internal
