// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/study/definition_values.h"

#include <algorithm>
#include <cctype>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "datasets/session/session_reader.h"

namespace plumbline::study_internal {

namespace fs = std::filesystem;

void refuseUnknownKeys(const YamlMap& map, std::initializer_list<const char*> known) {
  FaultList faults;
  for (const std::string& key : map.keys()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    faults.attempt([&] {
      throw map.fault(key, {InputFault::kUnknownWord, fmt::format("unknown key '{}'", key),
                            fmt::format("one of {}", fmt::join(known, ", "))});
    });
  }
  faults.raise();
}

double numberWithin(const YamlMap& map, const std::string& key, double least, double most,
                    const std::string& expected) {
  const double value = map.number(key, expected);
  if (value >= least && value <= most) return value;
  throw map.fault(key, {InputFault::kOutOfRange, fmt::format("{} is {:g}", key, value), expected});
}

double secondsOf(const YamlMap& map, const std::string& key) {
  return numberWithin(map, key, 0, kMostSeconds,
                      fmt::format("seconds, 0 to {:g} (a day)", kMostSeconds));
}

bool flagOf(const YamlMap& map, const std::string& key, bool otherwise) {
  if (!map.has(key)) return otherwise;
  bool value = false;
  // Also yes, no, on and off, as YAML has them.
  if (YAML::convert<bool>::decode(map.node(key), value)) return value;
  throw map.fault(key, {InputFault::kUnknownWord, key + " is neither yes nor no", "true or false"});
}

// A name that is also that of a folder: hidden ones are results in the making, or left out of what
// is hashed. With 100 letters the longest name of a step, evaluate_TOOL_RECORDING, and what a
// result in the making has beside it, stay below the 255 of a file system.
std::string nameOf(const YamlMap& map, const std::string& key) {
  const std::string name = map.text(key, "a name");
  const bool plain = std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
  });
  if (!name.empty() && plain && name.front() != '.' && name.size() <= 100) return name;
  throw map.fault(key, {InputFault::kUnknownWord, fmt::format("'{}' cannot name a folder", name),
                        "letters, digits, '_', '-' and '.'"});
}

std::vector<std::string> wordsOf(const YamlMap& map, const std::string& key,
                                 const std::string& expected) {
  std::vector<std::string> words;
  const YAML::Node list = map.node(key);
  const auto refuse = [&] {
    return map.fault(key, {InputFault::kUnknownWord, key + " is not a list of words", expected});
  };
  if (!list.IsSequence()) throw refuse();
  for (const YAML::Node& entry : list) {
    if (!entry.IsScalar() || entry.Scalar().empty()) throw refuse();
    if (std::find(words.begin(), words.end(), entry.Scalar()) != words.end()) {
      throw map.fault(key,
                      {InputFault::kDuplicate,
                       fmt::format("'{}' is given twice in {}", entry.Scalar(), key), "each once"});
    }
    words.push_back(entry.Scalar());
  }
  return words;
}

fs::path pathOf(const YamlMap& map, const std::string& key) {
  const fs::path given = map.text(key, "a path, relative to the study's file");
  return fs::weakly_canonical(fs::absolute(fs::path(map.path()).parent_path() / given));
}

fs::path fileOf(const YamlMap& map, const std::string& key) {
  const fs::path path = pathOf(map, key);
  if (fs::is_regular_file(path)) return path;
  throw map.fault(key, {InputFault::kMissingFile, path.string() + " is not a file",
                        "a file, its path relative to the study's"});
}

fs::path recordingOf(const YamlMap& map, const std::string& key) {
  const fs::path path = pathOf(map, key);
  try {
    // What the commands would look for: a recording that they would refuse hours later is refused
    // now.
    findSession(path.string());
  } catch (const InputError& error) {
    throw map.fault(key, {InputFault::kMissingFile, error.what()});
  }
  return path;
}

bool isOneOf(const std::string& word, std::initializer_list<const char*> list) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

void Names::add(const YamlMap& map, const std::string& name) {
  const auto [first, fresh] = lines_.emplace(name, map.lineOf("name"));
  if (fresh) return;
  throw map.fault("name",
                  {InputFault::kDuplicate,
                   fmt::format("the name '{}' is given twice (line {})", name, first->second),
                   "each once", "rename one"});
}

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

/// What a command says against options; "": nothing.
std::string faultOf(const StudyOptionCheck& check, const StudyCommandOptions& options) {
  try {
    check(options);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

}  // namespace

StudyCommandOptions optionsOf(const YamlMap& map, const std::string& options_key,
                              const std::string& of_what, const StudyOptionCheck& check,
                              std::initializer_list<const char*> file_options) {
  StudyCommandOptions list;
  if (!map.has(options_key)) return list;
  const YamlMap options = map.map(options_key, "options of " + of_what + ", by name");
  for (const std::string& key : options.keys()) {
    std::string option = key;
    // YAML's keys are written either way; the command line has hyphens.
    std::replace(option.begin(), option.end(), '_', '-');
    const bool is_file = isOneOf(option, file_options);
    std::string words = is_file ? fileOf(options, key).string() : options.text(key, "a value");
    // A flag, which the command line has without a word.
    if (words == "true") words = "";
    list.emplace_back(std::move(option), std::move(words));
  }
  const std::string wrong = faultOf(check, list);
  if (wrong.empty()) return list;
  // The line of the option that is refused for the same reason alone, if there is one.
  const std::vector<std::string> keys = options.keys();
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (faultOf(check, {list[i]}) != wrong) continue;
    throw options.fault(keys[i], {InputFault::kBadOption, wrong});
  }
  throw map.fault(options_key, {InputFault::kBadOption, wrong});
}

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
