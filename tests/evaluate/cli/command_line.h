// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace plumbline {

namespace fs = std::filesystem;
struct Outcome {
  int exit_code = -1;
  std::string text;  // standard output and error together
};

inline Outcome shell(const std::string& command) {
  Outcome outcome;
  std::FILE* pipe = popen(("( " + command + " ) 2>&1").c_str(), "r");
  char buffer[4096];
  while (std::fgets(buffer, sizeof buffer, pipe) != nullptr) outcome.text += buffer;
  const int status = pclose(pipe);
  if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
  return outcome;
}

inline Outcome plumbline(const std::string& arguments) {
  return shell(std::string(PLUMBLINE_BINARY) + " " + arguments);
}

/// Without the lines that long work writes into a pipe every ten seconds, as on a slow machine:
/// "plumbline: comparing the halves", "plumbline: detecting: 40 %, 12 s left".
inline std::string withoutProgress(const std::string& text) {
  static const std::regex progress(
      "plumbline: [A-Za-z ,-]+(: [0-9]+ %)?(, [0-9]+ (s|min) left)?\n");
  return std::regex_replace(text, progress, "");
}

inline std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void write(const fs::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

/// The files of a folder by name; of a result without its manifest.
inline std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file() && entry.path().filename() != "plumbline.json") {
      files[fs::relative(entry.path(), folder).string()] = read(entry.path());
    }
  }
  return files;
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  if (at != std::string::npos) text.replace(at, from.size(), to);
  return text;
}

/// A value of `option` (of `simulate sequence`, say) that is out of range is refused by the option
/// and as it was written; with an end of the range the command goes on to its rig, which is
/// unknown.
inline void expectRange(const std::string& command, const std::string& option,
                        const std::vector<std::string>& ends,
                        const std::vector<std::string>& outside) {
  const std::string before = command + " --rig nowhere --out nowhere " + option + " ";
  for (const std::string& value : outside) {
    const Outcome refused = plumbline(before + value);
    EXPECT_EQ(refused.exit_code, 2) << before << value;
    EXPECT_THAT(refused.text, testing::HasSubstr(option.substr(option.rfind("--")) + ": " + value +
                                                 ": expected " + ends[0] + " to " + ends[1]));
  }
  for (const std::string& value : ends) {
    EXPECT_THAT(plumbline(before + value).text, testing::HasSubstr("nowhere'")) << before << value;
  }
}

/// The names under "Subcommands:" in a help text.
inline std::vector<std::string> listedCommands(const std::string& help) {
  std::istringstream lines(help);
  std::string line;
  while (std::getline(lines, line) && line != "Subcommands:") {
  }
  std::vector<std::string> names;
  while (std::getline(lines, line) && line.rfind("  ", 0) == 0) {
    if (line[2] != ' ') names.push_back(line.substr(2, line.find(' ', 2) - 2));
  }
  return names;
}

/// A simulated session of corners, made once, of half as many frames as the rig's cameras make;
/// tests that spoil it work on copies.
class CommandLine : public testing::Test {
 protected:
  static void SetUpTestSuite() { makeSession("--duration 12 --camera-rate 10"); }
  static void makeSession(const std::string& options) {
    setenv("SOURCE_DATE_EPOCH", "1700000000", 1);
    root_ = fs::temp_directory_path() / ("plumbline_cli_" + std::to_string(getpid()));
    fs::remove_all(root_);
    fs::create_directories(root_);
    const Outcome outcome = plumbline("simulate --out " + (root_ / "session").string() +
                                      " --rig euroc --seed 3 " + options);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  }
  static void TearDownTestSuite() { fs::remove_all(root_); }
  void TearDown() override { fs::remove_all(scratch()); }

  static fs::path session() { return root_ / "session"; }
  fs::path scratch() const {
    std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    std::replace(name.begin(), name.end(), '/', '_');
    return root_ / name;
  }
  // A copy that may be spoiled; mav0() is where its streams lie.
  fs::path spoiled() const {
    fs::create_directories(scratch());
    fs::copy(session(), scratch() / "spoiled", fs::copy_options::recursive);
    return scratch() / "spoiled";
  }
  Outcome calibrate(const fs::path& folder, const std::string& options = "") const {
    return plumbline("calibrate " + folder.string() + " --out " + (scratch() / "out").string() +
                     " --no-cache --force " + options);
  }
  /// With the lens models that the session states, not those chosen by held-out frames, and without
  /// comparing halves: a quarter of the time, for tests of neither.
  Outcome calibrateAsStated(const fs::path& folder, const std::string& options = "") const {
    return calibrate(folder, "--models pinhole-radtan --no-halves " + options);
  }
  // Refused with this exit code, these words, and nothing left behind.
  void expectRefusal(const Outcome& outcome, int exit_code,
                     const testing::Matcher<std::string>& words) const {
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.text;
    EXPECT_THAT(outcome.text, words);
    const std::string said = withoutProgress(outcome.text);
    EXPECT_EQ(said.find("plumbline: "), 0u) << outcome.text;
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << outcome.text;
    EXPECT_FALSE(fs::exists(scratch() / "out")) << "a partial result was left";
  }

  static inline fs::path root_;
};

}  // namespace plumbline
