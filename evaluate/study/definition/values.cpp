// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/study/definition/values.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "datasets/session/session_folder.h"

namespace plumbline::study_internal {

namespace fs = std::filesystem;

void refuseUnknownKeys(const YamlMap& map, std::initializer_list<const char*> known) {
  FaultList faults;
  for (const std::string& key : map.keys()) {
    if (std::ranges::find(known, key) != known.end()) continue;
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
  const bool plain = std::ranges::all_of(name, [](unsigned char c) {
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
    if (std::ranges::find(words, entry.Scalar()) != words.end()) {
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
  return std::ranges::find(list, word) != list.end();
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

}  // namespace plumbline::study_internal
