// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/results/provenance.h"

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "datasets/files/file_io.h"
#include "datasets/files/numbers.h"
#include "datasets/files/workplace.h"
#include "generated/commit.h"
#include "generated/version.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

/// SOURCE_DATE_EPOCH (reproducible-builds.org): seconds since 1970 in place of now.
std::string nowUtc() {
  std::time_t now = std::time(nullptr);
  if (const char* fixed = std::getenv("SOURCE_DATE_EPOCH"); fixed != nullptr && *fixed != '\0') {
    now = static_cast<std::time_t>(std::strtoll(fixed, nullptr, 10));
  }
  return utcText(now);
}

/// One per process; a function, so that no other file's initialisation can come before its own.
std::vector<std::string>& keptArguments() {
  static std::vector<std::string> arguments;
  return arguments;
}

bool isImage(const fs::path& file) {
  const std::string ending = file.extension().string();
  return ending == ".png" || ending == ".jpg" || ending == ".jpeg";
}

/// Images by size alone: reading gigabytes of them takes longer than what is done with them.
std::string hashOfFile(const fs::path& file) {
  return isImage(file) ? fmt::format("{} bytes", fs::file_size(file))
                       : contentHash(MappedFile(file.string()).text());
}

std::string hashOfFolder(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  // A folder is listed in no order of its own.
  std::ranges::sort(files);
  std::string listed;
  for (const fs::path& file : files) {
    listed += fmt::format("{} {}\n", fs::relative(file, folder).string(), hashOfFile(file));
  }
  return contentHash(listed);
}

}  // namespace

std::string inputFilesHash(const std::vector<std::string>& inputs, const std::string& recording) {
  // A hash of the other inputs alone would call runs equal that are not.
  if (std::ranges::find(inputs, "-") != inputs.end()) return "";
  std::string listed = recording;
  for (const std::string& input : inputs) {
    listed += "\n" + (fs::is_directory(input) ? hashOfFolder(input) : hashOfFile(input));
  }
  return "xxh64:" + contentHash(listed);
}

std::string programVersion() {
  const std::string version = kVersion, commit = kCommit;
  return commit == "unknown" ? version : version + " (" + commit + ")";
}

void keepCommandLine(std::vector<std::string> arguments) {
  if (!arguments.empty()) arguments.front() = "plumbline";  // wherever it was installed
  keptArguments() = std::move(arguments);
}

std::string shellWords(const std::vector<std::string>& arguments) {
  const auto plain = [](char c) { return isPlain(c, "_-./:=,+@%^"); };
  std::string line;
  for (const std::string& argument : arguments) {
    if (!line.empty()) line += ' ';
    if (!argument.empty() && std::ranges::all_of(argument, plain)) {
      line += argument;
      continue;
    }
    line += '\'';
    // Within single quotes a shell changes nothing; a quote itself ends them, stands escaped, and
    // begins them again.
    for (const char c : argument) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    line += '\'';
  }
  return line;
}

Provenance makeProvenance(const std::string& command,
                          std::vector<std::pair<std::string, std::string>> options) {
  Provenance provenance;
  provenance.version = programVersion();
  // A study's step writes into a folder that gets its name when all is there.
  provenance.command =
      keptArguments().empty() ? command : withFinalNames(shellWords(keptArguments()));
  provenance.date = nowUtc();
  provenance.options = std::move(options);
  return provenance;
}

}  // namespace plumbline
