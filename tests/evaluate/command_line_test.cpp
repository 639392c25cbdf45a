// SPDX-License-Identifier: BSD-3-Clause
// The program as a user runs it: exit codes, messages, files left behind.
#include "tests/evaluate/command_line.h"

#include <vector>

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

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
  expectRefusal(calibrate(session(), "--models omni-radtan"), 2, HasSubstr("omni-radtan"));
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
  expectRefusal(calibrate(copy), 2, AllOf(HasSubstr("target.yaml:4:"), HasSubstr("tagSize")));
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
