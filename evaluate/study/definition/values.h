// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <exception>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "datasets/files/bad_input.h"
#include "datasets/files/yaml_map.h"
#include "evaluate/study/definition/definition.h"

namespace plumbline::study_internal {

/// Gathers what is wrong with an input, so that all of it is said at once.
class FaultList {
 public:
  /// Whether reading went well; what it throws is kept.
  bool attempt(const auto& read) {
    try {
      read();
      return true;
    } catch (const InputErrors& errors) {
      found_.insert(found_.end(), errors.all().begin(), errors.all().end());
    } catch (const InputError& error) {
      found_.push_back(error);
      last_ = std::current_exception();
    }
    return false;
  }

  /// Throws the only one as it was, or several as InputErrors in the order of their lines.
  void raise() {
    if (found_.empty()) return;
    std::ranges::stable_sort(found_, {}, &InputError::line);
    if (found_.size() == 1) std::rethrow_exception(last_);
    throw InputErrors(std::move(found_));
  }

 private:
  std::vector<InputError> found_;
  std::exception_ptr last_;
};

// Values of a study's definition. Each throws an InputError with file and line for another one.

// Nobody takes a day to record a session: larger numbers are milliseconds or stamps.
inline constexpr double kMostSeconds = 86400;

void refuseUnknownKeys(const YamlMap& map, std::initializer_list<const char*> known);
double numberWithin(const YamlMap& map, const std::string& key, double least, double most,
                    const std::string& expected);
/// Seconds of a person's work: 0 to a day.
double secondsOf(const YamlMap& map, const std::string& key);
bool flagOf(const YamlMap& map, const std::string& key, bool otherwise);
/// A name that can be that of a folder, too.
std::string nameOf(const YamlMap& map, const std::string& key);
/// A list of words, each once.
std::vector<std::string> wordsOf(const YamlMap& map, const std::string& key,
                                 const std::string& expected);
/// Absolute; as written it is relative to the definition's folder.
std::filesystem::path pathOf(const YamlMap& map, const std::string& key);
/// The same of a file that is there,
std::filesystem::path fileOf(const YamlMap& map, const std::string& key);
/// and of a recording's folder.
std::filesystem::path recordingOf(const YamlMap& map, const std::string& key);

bool isOneOf(const std::string& word, std::initializer_list<const char*> list);

/// Names that are given once.
class Names {
 public:
  void add(const YamlMap& map, const std::string& name);

 private:
  std::map<std::string, int> lines_;
};

/// The key `options_key` of a map: options of a command, by name, checked together. Values that
/// name files, those of `file_options`, are absolute from here on.
StudyCommandOptions optionsOf(const YamlMap& map, const std::string& options_key,
                              const std::string& of_what, const StudyOptionCheck& check,
                              std::initializer_list<const char*> file_options = {});

/// The key `sessions` of a study whose methods and limit were read.
void readSessions(const YamlMap& map, StudyDefinition& study);
/// What is held out was calibrated from by nobody.
void refuseSeenRecordings(const YamlMap& map, const StudyDefinition& study);
/// Every participant used every method: what is compared is compared within participants.
void refuseWithoutPair(const YamlMap& map, const StudyDefinition& study);

/// The key `trajectories` of a study whose sequences were read.
void readTrajectories(const YamlMap& map, const StudyOptionCheck& check, StudyDefinition& study);

}  // namespace plumbline::study_internal
