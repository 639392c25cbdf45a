// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/odometry/runner.h"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrator/base/error.h"
#include "datasets/files/yaml_map.h"
#include "evaluate/results/text.h"
#include "generated/evaluate/runners.h"

namespace plumbline {
namespace {

using Keys = std::span<const std::string_view>;
// `notes` is known and not read: it is for people.
constexpr std::array<std::string_view, 13> kKeys{
    "name",  "executable", "arguments",  "settings",   "files",  "environment", "trajectory",
    "clock", "body",       "imu_stamps", "least_runs", "online", "notes"};
constexpr std::array<std::string_view, 3> kOnlineKeys{"changes", "offset", "extrinsics"};

constexpr const char* kWhat = "a runner: name, executable, arguments";

void checkKeys(const YamlMap& file, Keys known) {
  for (const std::string& key : file.keys()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    throw file.fault(key, {InputFault::kUnknownWord, "the key '" + key + "' is not known",
                           fmt::format("{}", fmt::join(known, ", ")), "correct it"});
  }
}

/// Whether the value is the second of two words; the first where the key is missing.
bool isSecond(const YamlMap& file, const std::string& key, const char* first, const char* second) {
  const std::string word = file.textOr(key, first);
  if (word == first || word == second) return word == second;
  throw file.fault(key, {InputFault::kUnknownWord, "'" + word + "' is not known",
                         fmt::format("{} or {}", first, second)});
}

std::map<std::string, std::string> textsOf(const YamlMap& file, const std::string& key) {
  std::map<std::string, std::string> texts;
  if (!file.has(key)) return texts;
  const YamlMap map = file.map(key, "names and texts");
  for (const std::string& name : map.keys()) texts[name] = map.text(name, "a text");
  return texts;
}

/// A change to text that no file has would be passed over in silence.
void checkChanges(const YamlMap& map, const Runner& runner, const OnlineCalibration& online) {
  for (const auto& change : online.changes) {
    const std::string& text = change.first;
    const bool found = std::any_of(runner.files.begin(), runner.files.end(), [&](const auto& file) {
      return file.second.find(text) != std::string::npos;
    });
    if (found) continue;
    throw map.fault(text, {InputFault::kUnknownWord, "no file of the runner holds '" + text + "'",
                           "a text of `files`", "correct it"});
  }
}

OnlineCalibration onlineOf(const YamlMap& map, const Runner& runner) {
  checkKeys(map, kOnlineKeys);
  OnlineCalibration online{textsOf(map, "changes"), map.textOr("offset", ""),
                           map.textOr("extrinsics", "")};
  if (online.offset.empty() && online.extrinsics.empty()) {
    throw map.fault("offset", {InputFault::kMissingKey, "neither offset nor extrinsics is given",
                               "the text before the printed values"});
  }
  if (map.has("changes")) checkChanges(map.map("changes", "texts"), runner, online);
  return online;
}

/// Of the tools of export those that an odometry may be: camera_info holds no transform.
ExportTool settingsOf(const YamlMap& file) {
  const std::string word = file.text("settings", "a tool of plumbline export");
  std::vector<std::string> tools;
  for (const ExportTool tool : exportTools()) {
    if (tool == ExportTool::kCameraInfo) continue;
    if (toString(tool) == word) return tool;
    tools.push_back(toString(tool));
  }
  throw file.fault("settings", {InputFault::kUnknownWord,
                                "'" + word + "' is not a tool of export for systems with an IMU",
                                fmt::format("{}", fmt::join(tools, ", "))});
}

Runner runnerFrom(const YamlMap& file) {
  checkKeys(file, kKeys);
  Runner runner;
  runner.name = file.text("name", "a word for the page");
  runner.executable = file.text("executable", "a program");
  // Split before fields are filled in, so that a path with blanks stays one word.
  runner.words = wordsOf(file.text("arguments", "the arguments in one line"));
  runner.files = textsOf(file, "files");
  runner.environment = textsOf(file, "environment");
  runner.trajectory = file.textOr("trajectory", runner.trajectory);
  // clock and body are of what the system writes: imu stamps have t_d taken off, camera 0's poses
  // T_C0S put on (converted()). imu_stamps is of what it reads: IMU stamps on the cameras' clock
  // (linkSequence()).
  runner.imu_clock = isSecond(file, "clock", "camera", "imu");
  runner.camera_body = isSecond(file, "body", "imu", "camera0");
  runner.needs_shifted_imu = isSecond(file, "imu_stamps", "recorded", "shifted");
  if (file.has("least_runs")) runner.least_runs = file.integer("least_runs", "a number of runs");
  if (file.has("online")) {
    runner.online = onlineOf(file.map("online", "changes, offset, extrinsics"), runner);
  }
  if (!file.has("settings")) return runner;
  runner.settings = settingsOf(file);
  return runner;
}

}  // namespace

Runner readRunner(const std::string& path) { return runnerFrom(YamlMap::load(path, kWhat)); }

std::optional<Runner> knownRunner(const std::string& name) {
  // Compiled in, so that they are found wherever the program is installed.
  const auto shipped = [&](const std::string& text) {
    return runnerFrom(YamlMap::parse(text, name + ".yaml", kWhat));
  };
  if (name == "orbslam3") return shipped(embedded::runner_orbslam3());
  if (name == "openvins") return shipped(embedded::runner_openvins());
  return std::nullopt;
}

Runner runnerOf(const std::string& command) {
  Runner runner;
  std::vector<std::string> words = wordsOf(command);
  if (words.empty()) throw InputError("--with: expected builtin, orbslam3, openvins or a command");
  runner.executable = words.front();
  runner.words.assign(words.begin() + 1, words.end());
  const std::size_t slash = runner.executable.rfind('/');
  runner.name =
      slash == std::string::npos ? runner.executable : runner.executable.substr(slash + 1);
  return runner;
}

std::string filledIn(const std::string& text, const std::map<std::string, std::string>& fields) {
  std::string out;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t open = std::min(text.find('{', at), text.size());
    out += text.substr(at, open - at);
    if (open == text.size()) break;
    const std::size_t close = text.find('}', open);
    if (close == std::string::npos) {
      throw InputError(fmt::format("{}: {} is not closed; expected }}", text, text.substr(open)));
    }
    const std::string name = text.substr(open + 1, close - open - 1);
    const auto field = fields.find(name);
    if (field == fields.end()) {
      std::vector<std::string> known;
      for (const auto& [word, value] : fields) known.push_back("{" + word + "}");
      throw InputError(fmt::format("{}: the field {{{}}} is not known; expected {}", text, name,
                                   fmt::join(known, ", ")));
    }
    out += field->second;
    at = close + 1;
  }
  return out;
}

}  // namespace plumbline
