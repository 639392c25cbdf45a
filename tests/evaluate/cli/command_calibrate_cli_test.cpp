// SPDX-License-Identifier: BSD-3-Clause
// plumbline calibrate as a user runs it: which data it takes, what it leaves behind, what it
// refuses.
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/evaluate/cli/command_line.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

/// Half as many frames as the rig's cameras make: none of these tests is of accuracy.
class CommandCalibrate : public CommandLine {
 protected:
  static void SetUpTestSuite() { makeSession("--duration 12 --camera-rate 10"); }
};

// The whole number after the first `words`; -1 without them.
int numberAfter(const std::string& text, const std::string& words) {
  const auto at = text.find(words);
  return at == std::string::npos ? -1 : std::atoi(text.c_str() + at + words.size());
}

TEST_F(CommandCalibrate, OnlyTheCamerasAskedForAreCalibrated) {
  const Outcome outcome = calibrateAsStated(session(), "--only cam1 --no-imu --no-report");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const std::string json = read(scratch() / "out/calibration.json");
  EXPECT_THAT(json, HasSubstr("\"cam1.fu\""));
  EXPECT_THAT(json, testing::Not(HasSubstr("cam0.fu")));
}

TEST_F(CommandCalibrate, SelectedViewsAreFewerAndTheSeedIsKept) {
  const Outcome outcome = calibrateAsStated(
      session(), "--only cam0 --no-imu --no-report --select-views mi:0.4bits --seed 9");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const std::string json = read(scratch() / "out/calibration.json");
  const int used = numberAfter(json, "\"views_used\": ");
  EXPECT_GE(used, 5);
  EXPECT_LT(4 * used, numberAfter(json, "\"views_offered\": "));
  EXPECT_THAT(json, HasSubstr("\"--seed\": \"9\""));
}

TEST_F(CommandCalibrate, ResamplingReportsItsSpread) {
  const Outcome outcome =
      calibrateAsStated(session(), "--only cam0 --no-imu --no-report --resample 4");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const std::string json = read(scratch() / "out/calibration.json");
  EXPECT_EQ(numberAfter(json, "\"resamples\": "), 4);
  fs::remove_all(scratch());
  expectRefusal(calibrateAsStated(session(), "--resample 1"), 2, HasSubstr("--resample"));
}

TEST_F(CommandCalibrate, AResultStandsWhereItsBootstrapHasNoSpread) {
  const Outcome outcome =
      calibrateAsStated(session(), "--only cam0 --no-report --stride 4 --resample 2");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text,
              HasSubstr("caution - Bootstrap (camera-IMU): no bootstrap std: 2 of 2"));
  const std::string json = read(scratch() / "out/calibration.json");
  EXPECT_EQ(numberAfter(json, "\"resamples\": "), 2);
  EXPECT_THAT(json, HasSubstr("\"T_SC0\""));
}

TEST_F(CommandCalibrate, MoreCornersThanAViewHoldsAreAskedForByOption) {
  expectRefusal(calibrate(session(), "--min-corners 200"), 1,
                AllOf(HasSubstr("--min-corners 200"), HasSubstr("at least 200 corners"),
                      HasSubstr("most in one view is 144")));
}

TEST_F(CommandCalibrate, EveryFileReadIsInTheHash) {
  const auto hash = [&](const std::string& options) {
    const Outcome outcome = calibrate(session(), "--to 6 --no-halves --no-report " + options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    const std::string json = read(scratch() / "out/calibration.json");
    return json.substr(json.find("xxh64:"), 22);
  };
  const std::string stated = "--models pinhole-radtan ", plain = hash(stated);
  fs::rename(scratch() / "out", scratch() / "first");
  const fs::path camchain = scratch() / "first/camchain-imucam.yaml";
  const std::string given = hash("--cameras " + camchain.string());
  write(camchain, read(camchain) + "\n# another file\n");
  const std::string changed = hash("--cameras " + camchain.string());
  const fs::path imu = scratch() / "imu.yaml";
  write(imu, read(session() / "imu.yaml") + "# another\n");
  EXPECT_EQ(
      (std::set<std::string>{plain, given, changed, hash(stated + "--imu " + imu.string())}).size(),
      4U);
}

// All that a calibration does unless told otherwise, once: lens models are chosen, halves compared.
TEST_F(CommandCalibrate, CalibrateLeavesAllResultsWhateverTheThreadsAndTheRecordingAsItWas) {
  const auto before = contents(session());
  const Outcome outcome = calibrate(session(), "--residuals --threads 3");
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
  const std::string three = read(scratch() / "out/camchain-imucam.yaml");
  ASSERT_EQ(calibrate(session(), "--threads 1 --no-report").exit_code, 0);
  EXPECT_EQ(read(scratch() / "out/camchain-imucam.yaml"), three);
}

TEST_F(CommandCalibrate, ReportIsMadeAgainFromTheRecordsAlone) {
  // With halves to compare and a lens model to choose, of one camera.
  ASSERT_EQ(calibrate(session(), "--only cam0").exit_code, 0);
  const fs::path out = scratch() / "out", again = scratch() / "again.html";
  const std::string page = read(out / "report.html");
  const Outcome outcome = plumbline("report " + out.string() + " --out " + again.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_EQ(read(again), page);
  for (const std::string name : {"again", "again.htm", "records.sqlite"}) {
    const fs::path other = scratch() / name;
    const Outcome refused = plumbline("report " + out.string() + " --out " + other.string());
    EXPECT_EQ(refused.exit_code, 2) << name;
    EXPECT_THAT(refused.text, HasSubstr(name + ": expected a name that ends in .html"));
    EXPECT_FALSE(fs::exists(other));
  }
  EXPECT_EQ(plumbline("report " + session().string() + " --out x.html").exit_code, 2);
  const fs::path empty = scratch() / "empty.sqlite";
  write(empty, "");
  EXPECT_THAT(plumbline("report " + empty.string() + " --out x.html").text,
              HasSubstr("empty.sqlite: is empty; expected a records file"));
  const std::string document = read(out / "calibration.json");
  const Outcome piped = plumbline("report " + out.string() + " --json - 2>/dev/null");
  EXPECT_EQ(piped.exit_code, 0);
  EXPECT_EQ(piped.text, document);
  const fs::path file = scratch() / "again.json";
  ASSERT_EQ(plumbline("report " + out.string() + " --json " + file.string()).exit_code, 0);
  EXPECT_EQ(read(file), document);
  EXPECT_EQ(plumbline("report " + out.string()).exit_code, 2);
}

TEST_F(CommandCalibrate, ResultsAreWrittenTogetherOrNotAtAll) {
  const fs::path out = scratch() / "out";
  fs::create_directories(out / "report.html");
  write(out / "calibration.json", "earlier");
  const Outcome outcome = calibrateAsStated(session());
  EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("calibration.json: was not written by plumbline"));
  EXPECT_EQ(read(out / "calibration.json"), "earlier");
  EXPECT_EQ(contents(out).size(), 1U);
  fs::remove_all(out);
  ASSERT_EQ(calibrateAsStated(session()).exit_code, 0);
  for (const auto& [name, text] : contents(out)) EXPECT_EQ(name.find('.') == 0, false) << name;
  ASSERT_EQ(calibrateAsStated(session(), "--no-imu --no-report").exit_code, 0);
  for (const char* name : {"report.html", "imu.yaml", "camchain-imucam.yaml"}) {
    EXPECT_FALSE(fs::exists(out / name)) << name << " is of an earlier run";
  }
}

TEST_F(CommandCalibrate, ItsOwnCalibrationIsAStartForTheNext) {
  ASSERT_EQ(calibrateAsStated(session(), "--no-report").exit_code, 0);
  fs::rename(scratch() / "out", scratch() / "first");
  for (const char* file : {"calibration.json", "camchain-imucam.yaml"}) {
    const Outcome outcome = calibrate(
        session(), "--no-halves --no-report --cameras " + (scratch() / "first" / file).string());
    EXPECT_EQ(outcome.exit_code, 0) << file << outcome.text;
    EXPECT_EQ(read(scratch() / "out/imu.yaml"), read(scratch() / "first/imu.yaml"));
  }
}

TEST_F(CommandCalibrate, MissingPiecesAreNamed) {
  for (const char* name : {"target.yaml", "imu.yaml", "mav0/cam1/sensor.yaml"}) {
    const fs::path copy = spoiled();
    fs::remove(copy / name);
    if (std::string(name) == "imu.yaml") fs::remove(copy / "mav0/imu0/sensor.yaml");
    expectRefusal(calibrate(copy), 2, HasSubstr(fs::path(name).filename().string()));
    fs::remove_all(scratch());
  }
}

TEST_F(CommandCalibrate, FaultyRowsAreNamedByFileAndLine) {
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
    expectRefusal(calibrateAsStated(copy), 2, AllOf(HasSubstr("imu0/data.csv"), HasSubstr(words)));
  }
}

TEST_F(CommandCalibrate, GivenCamerasAreBlamedForPosesThatTheySpoil) {
  const std::string truth = read(session() / "truth/camchain-imucam.yaml");
  fs::create_directories(scratch());
  const fs::path file = scratch() / "equidistant.yaml";
  write(file, replaced(replaced(truth, "radtan", "equidistant"), "radtan", "equidistant"));
  expectRefusal(calibrate(session(), "--no-halves --cameras " + file.string()), 2,
                AllOf(HasSubstr("the given cameras do not explain the corners"),
                      HasSubstr("--free-cameras")));
  // What is found in the stamps stands on no poses: it is said as with good cameras.
  const Outcome apart =
      calibrate(session(), "--no-halves --imu-shift-ms 1e6 --cameras " + file.string());
  EXPECT_EQ(apart.exit_code, 1) << apart.text;
  EXPECT_THAT(apart.text, Not(HasSubstr("do not explain the corners")));
}

// The shift helps to find it; the offset is that of the recording.
TEST_F(CommandCalibrate, AnImuShiftIsNotInTheOffsetThatIsWritten) {
  const auto offset_s = [&](const std::string& options) {
    const Outcome outcome = calibrateAsStated(session(), "--no-report --no-halves " + options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    const auto document = nlohmann::json::parse(read(scratch() / "out/calibration.json"));
    fs::remove_all(scratch());
    return document.at("stages").at("camera_imu").at("time_offset_s").get<double>();
  };
  EXPECT_NEAR(offset_s("--imu-shift-ms 200"), offset_s(""), 5e-6);
}

// They would be taken for ours from then on, with the errors that our detector makes alike.
TEST_F(CommandCalibrate, DetectRefusesCornersThatAreGiven) {
  fs::create_directories(scratch());
  const Outcome outcome = plumbline("detect " + session().string() + " --no-cache --out " +
                                    (scratch() / "corners").string());
  EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("there is nothing to detect"));
  EXPECT_FALSE(fs::exists(scratch() / "corners"));
}

TEST_F(CommandCalibrate, WrongTargetSizeIsFoundByTheImu) {
  const fs::path copy = spoiled();
  const std::string target = read(copy / "target.yaml");
  write(copy / "target.yaml", replaced(target, "0.088", "0.110"));
  expectRefusal(calibrateAsStated(copy), 2,
                AllOf(HasSubstr("target.yaml:4:"), HasSubstr("tagSize")));
}

TEST_F(CommandCalibrate, CameraWithoutDetectionsIsNamed) {
  const fs::path copy = spoiled();
  write(copy / "mav0/cam1/corners.csv", "#timestamp [ns],corner_id,u [px],v [px]\n");
  expectRefusal(calibrateAsStated(copy), 1, HasSubstr("cam1"));
}

TEST_F(CommandCalibrate, TooFewViewsAreRefused) {
  expectRefusal(calibrate(session(), "--to 0.06"), 1, HasSubstr("view"));
}

}  // namespace
}  // namespace plumbline
