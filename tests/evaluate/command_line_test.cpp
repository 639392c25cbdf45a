// SPDX-License-Identifier: BSD-3-Clause
// The program as a user runs it: exit codes, messages, files left behind.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

struct Outcome {
  int exit_code = -1;
  std::string text;  // standard output and error together
};

Outcome plumbline(const std::string& arguments) {
  const std::string command = std::string(PLUMBLINE_BINARY) + " " + arguments + " 2>&1";
  Outcome outcome;
  std::FILE* pipe = popen(command.c_str(), "r");
  char buffer[4096];
  while (std::fgets(buffer, sizeof buffer, pipe) != nullptr) outcome.text += buffer;
  const int status = pclose(pipe);
  if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
  return outcome;
}

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write(const fs::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) {
      files[fs::relative(entry.path(), folder).string()] = read(entry.path());
    }
  }
  return files;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  if (at != std::string::npos) text.replace(at, from.size(), to);
  return text;
}

// A simulated session of corners, made once; tests that spoil it work on copies.
class CommandLine : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    setenv("SOURCE_DATE_EPOCH", "1700000000", 1);
    root_ = fs::temp_directory_path() / ("plumbline_cli_" + std::to_string(getpid()));
    fs::create_directories(root_);
    const Outcome outcome = plumbline("simulate --out " + (root_ / "session").string() +
                                      " --rig euroc --seed 3 --duration 12");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  }
  static void TearDownTestSuite() { fs::remove_all(root_); }
  void TearDown() override { fs::remove_all(scratch()); }

  static fs::path session() { return root_ / "session"; }
  fs::path scratch() const {
    return root_ / testing::UnitTest::GetInstance()->current_test_info()->name();
  }
  // A copy that may be spoiled; mav0() is where its streams lie.
  fs::path spoiled() const {
    fs::create_directories(scratch());
    fs::copy(session(), scratch() / "spoiled", fs::copy_options::recursive);
    return scratch() / "spoiled";
  }
  Outcome calibrate(const fs::path& folder, const std::string& options = "") const {
    return plumbline("calibrate " + folder.string() + " --out " + (scratch() / "out").string() +
                     " --no-cache " + options);
  }
  // Refused with this exit code, these words, and nothing left behind.
  void expectRefusal(const Outcome& outcome, int exit_code,
                     const testing::Matcher<std::string>& words) const {
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.text;
    EXPECT_THAT(outcome.text, words);
    EXPECT_FALSE(fs::exists(scratch() / "out")) << "a partial result was left";
  }

  static fs::path root_;
};
fs::path CommandLine::root_;

TEST_F(CommandLine, EveryCommandHasHelpWithAnExample) {
  for (const char* command : {"simulate", "detect", "calibrate", "report"}) {
    const Outcome outcome = plumbline(std::string(command) + " --help");
    EXPECT_EQ(outcome.exit_code, 0) << command;
    EXPECT_THAT(outcome.text, HasSubstr(std::string("plumbline ") + command)) << command;
    EXPECT_THAT(outcome.text, HasSubstr("Example")) << command;
  }
  EXPECT_EQ(plumbline("--version").exit_code, 0);
}

TEST_F(CommandLine, UsageErrorsExitWithTwo) {
  EXPECT_EQ(plumbline("").exit_code, 2);
  EXPECT_EQ(plumbline("calibrat").exit_code, 2);
  EXPECT_EQ(plumbline("calibrate").exit_code, 2);
  EXPECT_EQ(plumbline("calibrate session --out x --unknown").exit_code, 2);
  expectRefusal(calibrate(session(), "--loss huber"), 2, HasSubstr("cauchy:1.5"));
  expectRefusal(calibrate(session(), "--stride 0"), 2, HasSubstr("--stride"));
  expectRefusal(calibrate(session(), "--only cam7"), 2, HasSubstr("cam0, cam1"));
  expectRefusal(calibrate(session(), "--models omni-radtan"), 2, HasSubstr("not supported"));
  expectRefusal(calibrate("/nowhere"), 2, HasSubstr("/nowhere"));
}

TEST_F(CommandLine, CalibrateLeavesAllResultsAndTheRecordingAsItWas) {
  const auto before = contents(session());
  const Outcome outcome = calibrate(session(), "--residuals");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text,
              AllOf(HasSubstr("T_SC0"), HasSubstr("Verdict"), HasSubstr("report.html")));
  EXPECT_EQ(contents(session()), before);
  std::vector<std::string> names;
  for (const auto& [name, text] : contents(scratch() / "out")) {
    names.push_back(name);
    EXPECT_THAT(text, testing::Not(IsEmpty())) << name;
  }
  EXPECT_THAT(names,
              testing::UnorderedElementsAre("calibration.json", "camchain-imucam.yaml", "imu.yaml",
                                            "records.sqlite", "report.html", "residuals.csv"));
}

TEST_F(CommandLine, ResultsDoNotDependOnTheNumberOfThreads) {
  ASSERT_EQ(calibrate(session(), "--threads 1 --no-report").exit_code, 0);
  const std::string one = read(scratch() / "out/camchain-imucam.yaml");
  ASSERT_EQ(calibrate(session(), "--threads 3 --no-report").exit_code, 0);
  EXPECT_EQ(read(scratch() / "out/camchain-imucam.yaml"), one);
}

TEST_F(CommandLine, ReportIsMadeAgainFromTheRecordsAlone) {
  ASSERT_EQ(calibrate(session()).exit_code, 0);
  const std::string page = read(scratch() / "out/report.html");
  const fs::path again = scratch() / "again.html";
  const Outcome outcome =
      plumbline("report " + (scratch() / "out").string() + " --out " + again.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_EQ(read(again), page);
  EXPECT_EQ(plumbline("report " + session().string() + " --out x.html").exit_code, 2);
}

TEST_F(CommandLine, ItsOwnCalibrationIsAStartForTheNext) {
  ASSERT_EQ(calibrate(session(), "--no-report").exit_code, 0);
  fs::rename(scratch() / "out", scratch() / "first");
  for (const char* file : {"calibration.json", "camchain-imucam.yaml"}) {
    const Outcome outcome =
        calibrate(session(), "--no-report --cameras " + (scratch() / "first" / file).string());
    EXPECT_EQ(outcome.exit_code, 0) << file << outcome.text;
    EXPECT_EQ(read(scratch() / "out/imu.yaml"), read(scratch() / "first/imu.yaml"));
  }
}

TEST_F(CommandLine, MissingPiecesAreNamed) {
  for (const char* name : {"target.yaml", "imu.yaml", "mav0/cam1/sensor.yaml"}) {
    const fs::path copy = spoiled();
    fs::remove(copy / name);
    if (std::string(name) == "imu.yaml") fs::remove(copy / "mav0/imu0/sensor.yaml");
    expectRefusal(calibrate(copy), 2, HasSubstr(fs::path(name).filename().string()));
    fs::remove_all(scratch());
  }
}

TEST_F(CommandLine, FaultyRowsAreNamedByFileAndLine) {
  const fs::path copy = spoiled();
  const fs::path csv = copy / "mav0/imu0/data.csv";
  const std::string good = read(csv);
  const auto second_row = good.find('\n', good.find('\n') + 1) + 1;
  const std::map<std::string, std::string> faults{
      {good.substr(0, second_row) + "abc,1,2,3,4,5,6\n" + good.substr(second_row), ":3:"},
      {good.substr(0, second_row) + "1,nan,2,3,4,5,6\n" + good.substr(second_row), ":3:"},
      {good + good.substr(second_row, 60), "data.csv:"},
      {"", "data.csv"}};
  for (const auto& [text, words] : faults) {
    write(csv, text);
    expectRefusal(calibrate(copy), 2, AllOf(HasSubstr("imu0/data.csv"), HasSubstr(words)));
  }
}

TEST_F(CommandLine, WrongTargetSizeIsFoundByTheImu) {
  const fs::path copy = spoiled();
  const std::string target = read(copy / "target.yaml");
  write(copy / "target.yaml", replaced(target, "0.088", "0.110"));
  expectRefusal(calibrate(copy), 1, HasSubstr("tagSize"));
}

TEST_F(CommandLine, CameraWithoutDetectionsIsNamed) {
  const fs::path copy = spoiled();
  write(copy / "mav0/cam1/corners.csv", "#timestamp [ns],corner_id,u [px],v [px]\n");
  expectRefusal(calibrate(copy), 1, HasSubstr("cam1"));
}

TEST_F(CommandLine, TooFewViewsAreRefused) {
  expectRefusal(calibrate(session(), "--to 0.06"), 1, HasSubstr("view"));
}

}  // namespace
}  // namespace plumbline
