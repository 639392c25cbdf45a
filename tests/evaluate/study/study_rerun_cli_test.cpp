// SPDX-License-Identifier: BSD-3-Clause
// What a night does again: what changed, and nothing else.
#include "tests/evaluate/study/study_nights.h"

namespace plumbline {
namespace {

class StudyRerun : public StudyNights {};

TEST_F(StudyRerun, AnUnchangedNightDoesNothingAgain) {
  const fs::path night = doneNight();
  const auto before = times(night);
  EXPECT_EQ(before.size(), 12u);
  const Outcome outcome = study(root_ / "data", night);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("Night 2: 4 of 4 sessions"));
  EXPECT_TRUE(doneAgain(before, night).empty());
  EXPECT_EQ(values(night), values(root_ / "undisturbed"));
  const auto summary = nlohmann::json::parse(read(night / "summary.json"));
  EXPECT_EQ(summary.at("nights").size(), 2u);
  EXPECT_EQ(summary.at("sessions").size(), 4u);
  EXPECT_GT(summary.at("sessions")[0].at("held_out_rmse_px").get<double>(), 0.1);
  EXPECT_TRUE(fs::exists(night / summary.at("sessions")[0].at("page").get<std::string>()));
  EXPECT_THAT(read(night / "index.html"), HasSubstr("p2_guided"));
}

TEST_F(StudyRerun, ResultsDoNotDependOnJobs) {
  const Outcome outcome = study(root_ / "data", scratch_ / "night", "--jobs 1");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_EQ(values(scratch_ / "night"), values(root_ / "undisturbed"));
  // Nor is it among the options that the result states; the command line has it.
  EXPECT_THAT(read(scratch_ / "night/summary.json"),
              testing::AllOf(HasSubstr("--jobs 1"), Not(HasSubstr("\"--jobs\""))));
}

TEST_F(StudyRerun, AChangedSessionAloneIsDoneAgain) {
  const fs::path data = ownData(), night = doneNight();
  const auto before = times(night);
  fs::remove_all(data / "p1_free");
  fs::copy(data / "eval", data / "p1_free", fs::copy_options::recursive);
  EXPECT_EQ(study(data, night).exit_code, 0);
  EXPECT_EQ(doneAgain(before, night),
            (std::set<std::string>{"sessions/p1_free/calibrate", "sessions/p1_free/evaluate_eval",
                                   "sessions/p1_free/perturb"}));
}

TEST_F(StudyRerun, AStepThatIsDoneAgainKeepsWhatOthersPutIntoItsFolder) {
  const fs::path night = doneNight(), step = night / "sessions/p1_free/calibrate";
  write(step / "notes.txt", "mine");
  const auto before = times(night);
  EXPECT_EQ(study(root_ / "data", night, "--recheck 12").exit_code, 0);
  EXPECT_EQ(doneAgain(before, night).size(), 12u);
  EXPECT_EQ(read(step / "notes.txt"), "mine");
}

// The hidden one, in which it was made, is gone.
TEST_F(StudyRerun, ResultsNameTheFolderThatTheyAreIn) {
  const fs::path night = root_ / "undisturbed", step = night / "sessions/p1_free/calibrate";
  for (const char* name : {"log.txt", "calibration.json", "report.html"}) {
    EXPECT_THAT(read(step / name), Not(HasSubstr(".partial-"))) << name;
  }
  EXPECT_THAT(read(step / "log.txt"), HasSubstr((step / "report.html").string()));
}

TEST_F(StudyRerun, RecordsOfStepsStayWhereTheStudySaysSo) {
  const fs::path data = ownData(), night = doneNight();
  const auto records = [&] {
    int count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(night / "sessions")) {
      count += entry.path().filename() == "records.sqlite" ? 1 : 0;
    }
    return count;
  };
  EXPECT_EQ(records(), 0);
  const auto before = times(night);
  write(data / "STUDY.yaml", read(data / "STUDY.yaml") + "keep_records: true\n");
  EXPECT_EQ(study(data, night).exit_code, 0);
  EXPECT_EQ(doneAgain(before, night).size(), 12u);
  EXPECT_EQ(records(), 12);
  const auto summary = nlohmann::json::parse(read(night / "summary.json"));
  EXPECT_FALSE(summary.contains("alarms"));
}

TEST_F(StudyRerun, ACorruptSessionCostsItselfAlone) {
  const fs::path data = ownData();
  write(data / "p1_free/mav0/cam0/corners.csv", "no corners\n1,2\n");
  const Outcome outcome = study(data, scratch_ / "night");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("3 of 4 sessions have a calibration"));
  const auto summary = nlohmann::json::parse(read(scratch_ / "night/summary.json"));
  const auto& session = summary.at("sessions")[0];
  EXPECT_EQ(session.at("status"), "failed");
  EXPECT_EQ(session.at("failed_step"), "calibrate");
  EXPECT_THAT(session.at("message").get<std::string>(), HasSubstr("corners.csv"));
  EXPECT_EQ(summary.at("held_out").size(), 3u);
  const auto before = times(scratch_ / "night");
  EXPECT_EQ(study(data, scratch_ / "night").exit_code, 0);
  EXPECT_TRUE(doneAgain(before, scratch_ / "night").empty()) << "it would fail again";
  EXPECT_EQ(study(data, scratch_ / "night", "--redo-failed").exit_code, 0);
  EXPECT_EQ(doneAgain(before, scratch_ / "night").size(), 1u);
}

TEST_F(StudyRerun, ASessionThatIsDamagedAfterItsCalibrationIsNamed) {
  const fs::path data = ownData(), night = doneNight();
  write(data / "p1_free/mav0/cam0/corners.csv", "no corners\n1,2\n");
  const Outcome outcome = study(data, night);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text,
              HasSubstr("had one on an earlier night, from other data or options: p1_free"));
  EXPECT_THAT(read(night / "index.html"), HasSubstr("Sessions calibrated before"));
}

TEST_F(StudyRerun, TheListOfCommandsGivesTheSameStore) {
  const fs::path night = scratch_ / "night";
  const Outcome list = study(root_ / "data", night, "--engine commands");
  ASSERT_EQ(list.exit_code, 0) << list.text;
  EXPECT_EQ(std::count(list.text.begin(), list.text.end(), '\n'), 12 + 2 + 2);
  write(scratch_ / "commands.sh", list.text);
  EXPECT_EQ(WEXITSTATUS(std::system(
                ("sh " + (scratch_ / "commands.sh").string() + " >/dev/null 2>&1").c_str())),
            0);
  EXPECT_EQ(values(night), values(root_ / "undisturbed"));
}

TEST_F(StudyRerun, OptionsOfCalibrateAreCheckedBeforeAnythingRuns) {
  const fs::path data = ownData();
  const std::string good = read(data / "STUDY.yaml");
  for (const char* options :
       {"{loss: cauchy}", "{pixel-sigma: -1}", "{colour: red}", "{out: here}", "{models: fisheye}",
        "{fail-on: bad}", "{json: all.json}", "{threshold: 'rmse_px=abc'}", "{imu-shift-ms: 1e9}",
        "{sync-tolerance-ms: 1e8}", "{from: 5, to: 4}", "{free-cameras: true}",
        "{loss: 'cauchy:1e-4'}", "{cameras: STUDY.yaml, no-imu: true}"}) {
    write(data / "STUDY.yaml",
          replaced(good, kCalibrate, std::string("calibrate: ") + options + "\n"));
    const Outcome outcome = study(data, scratch_ / "night");
    EXPECT_EQ(outcome.exit_code, 2) << options;
    EXPECT_THAT(outcome.text, HasSubstr("STUDY.yaml:10: ")) << options;
    EXPECT_FALSE(fs::exists(scratch_ / "night"));
  }
  // The plan gives models to steps that are given no cameras.
  write(data / "STUDY.yaml",
        replaced(good, kCalibrate, "calibrate: {models: pinhole-radtan, cameras: STUDY.yaml}\n"));
  EXPECT_EQ(study(data, scratch_ / "night", "--engine commands").exit_code, 0);
}

}  // namespace
}  // namespace plumbline
