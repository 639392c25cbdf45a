// SPDX-License-Identifier: BSD-3-Clause
// Trajectories of a study by every source, and what guided sessions say of their operators.
#include <sstream>

#include "tests/evaluate/study/study_nights.h"

namespace plumbline {
namespace {

class StudyTrajectoryNights : public StudyStepNights {};

TEST_F(StudyTrajectoryNights, TrajectoriesComeFromACommandOrAPattern) {
  const fs::path data = ownData();
  doneNight();
  const std::string study_file = read(data / "STUDY.yaml") +
                                 "sequences: [{name: s, path: eval, truth: "
                                 "eval/truth/trajectory.csv}]\n";
  write(data / "STUDY.yaml", study_file +
                                 "trajectories: {command: 'test -f {calibration} && cp "
                                 "{sequence}/truth/trajectory.csv {out}'}\n");
  EXPECT_EQ(study(data, scratch_ / "night").exit_code, 0);
  auto summary = nlohmann::json::parse(read(scratch_ / "night/summary.json"));
  ASSERT_EQ(summary.at("trajectories").size(), 4u);
  EXPECT_LT(summary.at("trajectories")[0].at("ate_m").get<double>(), 1e-9);
  std::string said = "a";
  for (int i = 0; i < 400; ++i) said += "\u00e4";
  write(data / "STUDY.yaml", study_file + "trajectories: {command: 'echo " + said + "; exit 3'}\n");
  EXPECT_EQ(study(data, scratch_ / "night").exit_code, 0);
  summary = nlohmann::json::parse(read(scratch_ / "night/summary.json"));
  EXPECT_THAT(summary.at("trajectories")[0].at("failure").get<std::string>(),
              HasSubstr("\u00e4\u00e4..."));
  fs::create_directories(data / "runs/p1_free");
  fs::copy(data / "eval/truth/trajectory.csv", data / "runs/p1_free/s_1.txt");
  write(data / "runs/p1_free/s_2.txt", "no trajectory\n");
  write(data / "STUDY.yaml",
        study_file + "trajectories: {pattern: 'runs/{calibration}/{sequence}_{run}.txt'}\n");
  EXPECT_EQ(study(data, scratch_ / "night").exit_code, 0);
  summary = nlohmann::json::parse(read(scratch_ / "night/summary.json"));
  ASSERT_EQ(summary.at("trajectories").size(), 2u);
  EXPECT_EQ(summary.at("trajectories")[0].at("run"), "1");
  EXPECT_LT(summary.at("trajectories")[0].at("ate_m").get<double>(), 1e-9);
  EXPECT_THAT(summary.at("trajectories")[1].at("failure").get<std::string>(), HasSubstr("s_2.txt"));
}

TEST_F(StudyTrajectoryNights, TheBuiltInOdometryRunsWithEveryCalibration) {
  const fs::path data = ownData();
  const std::string odometry = std::string(kSequence) + "trajectories: {odometry: builtin";
  const Json summary = night(data, odometry + "}\n");
  ASSERT_EQ(summary.at("trajectories").size(), 4u);
  for (const Json& row : summary.at("trajectories")) {
    EXPECT_EQ(row.at("sequence"), "s");
    EXPECT_LT(row.at("ate_m").get<double>(), 0.05) << row;
    EXPECT_GT(row.at("ate_m").get<double>(), 1e-6) << row;
  }
  EXPECT_THAT(read(scratch_ / "night/index.html"), HasSubstr("Absolute trajectory errors"));
  const auto before = times(scratch_ / "night");
  EXPECT_EQ(before.size(), 16u);
  night(data, odometry + "}\n");
  EXPECT_TRUE(doneAgain(before, scratch_ / "night").empty());
  const Json scaled = night(data, odometry + ", metrics: {align: sim3}}\n");
  EXPECT_EQ(
      doneAgain(before, scratch_ / "night"),
      (std::set<std::string>{"sessions/p1_free/odometry_s", "sessions/p1_guided/odometry_s",
                             "sessions/p2_free/odometry_s", "sessions/p2_guided/odometry_s"}));
  for (std::size_t i = 0; i < 4; ++i) {  // a scale more to fit: no error is larger for it
    EXPECT_LE(scaled.at("trajectories")[i].at("ate_m").get<double>(),
              summary.at("trajectories")[i].at("ate_m").get<double>());
  }
}

// A stand-in that copies the truth: its errors are zero, each of its runs is a row.
TEST_F(StudyTrajectoryNights, AnotherOdometryRunsByItsDescription) {
  const fs::path data = ownData();
  for (const char* camera : {"cam0", "cam1"}) {
    const fs::path folder = data / "eval/mav0" / camera;
    fs::create_directories(folder / "data");
    std::istringstream list(read(folder / "data.csv"));
    for (std::string line; std::getline(list, line);) {
      if (line[0] != '#') write(folder / "data" / line.substr(line.find(',') + 1), "x");
    }
  }
  write(data / "copy.sh", "#!/bin/sh\nexec cp \"$1\" \"$2\"\n");
  fs::permissions(data / "copy.sh", fs::perms::owner_all);
  write(data / "copy.yaml",
        "name: copy\nexecutable: nowhere\n"
        "arguments: '{sequence}/truth/trajectory.csv {output}/trajectory.txt'\n");
  const std::string how = "trajectories: {odometry: copy.yaml, executable: copy.sh, runs: 2}\n";
  const Json summary = night(data, kSequence + how);
  ASSERT_EQ(summary.at("trajectories").size(), 8u);
  EXPECT_EQ(summary.at("trajectories")[1].at("run"), "2");
  EXPECT_LT(summary.at("trajectories")[1].at("ate_m").get<double>(), 1e-6);
  write(data / "copy.sh", "#!/bin/sh\nexit 3\n");
  const Json failed = night(data, kSequence + how);
  EXPECT_THAT(failed.at("trajectories")[0].at("failure").get<std::string>(),
              HasSubstr("exit code 3"));
}

// What the simulated operator reached is read from the recording; a replay says the same.
TEST_F(StudyTrajectoryNights, GuidedSessionsSayHowTheirSuggestionsWereFollowed) {
  const fs::path data = scratch_ / "data";
  const Outcome made =
      plumbline("simulate study --participants 1 --duration 8 --held-out 0 --sequences 1 --out " +
                data.string());
  ASSERT_EQ(made.exit_code, 0) << made.text;
  write(data / "STUDY.yaml", read(data / "STUDY.yaml") + kCalibrate + "endpoints: [capture_s]\n");
  write(data / "STUDY.yaml", replaced(replaced(read(data / "STUDY.yaml"),
                                               "endpoints: [held_out_rmse_px, capture_s]\n", ""),
                                      "offsets_ms: [100, 10, 1]", "offsets_ms: [10]"));
  ASSERT_EQ(study(data, scratch_ / "night").exit_code, 0);
  Json summary = Json::parse(read(scratch_ / "night/summary.json"));
  const Json truth = Json::parse(read(data / "truth.json"));
  std::map<std::string, double> read_off;
  for (const Json& session : summary.at("sessions")) {
    if (session.contains("compliance")) {
      read_off[session.at("name")] = session.at("compliance").get<double>();
    }
  }
  ASSERT_EQ(read_off.size(), 1u);
  for (const Json& session : truth.at("sessions")) {
    if (session.at("method") != "guided") continue;
    const double all = session.at("suggestions").get<double>();
    EXPECT_NEAR(read_off.at(session.at("name")), session.at("reached").get<double>() / all,
                1.01 / all);
  }
  EXPECT_THAT(read(scratch_ / "night/index.html"), HasSubstr("Suggestions reached"));
  ASSERT_EQ(summary.at("trajectories").size(), 2u);  // the sequence, against motion capture
  for (const Json& row : summary.at("trajectories")) {
    EXPECT_LT(row.at("ate_m").get<double>(), 0.05) << row;
  }
  write(data / "STUDY.yaml", read(data / "STUDY.yaml") + "replay: true\n");
  ASSERT_EQ(study(data, scratch_ / "night").exit_code, 0);
  summary = Json::parse(read(scratch_ / "night/summary.json"));
  EXPECT_TRUE(fs::exists(scratch_ / "night/sessions/p01_guided/replay/report.html"));
  for (const Json& session : summary.at("sessions")) {
    if (session.at("name") != "p01_guided") continue;
    EXPECT_NEAR(session.at("compliance").get<double>(), read_off.at("p01_guided"), 0.2);
  }
}

}  // namespace
}  // namespace plumbline
