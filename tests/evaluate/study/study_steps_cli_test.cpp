// SPDX-License-Identifier: BSD-3-Clause
// The steps that a study has only where its definition asks for them.
#include "tests/evaluate/study/study_nights.h"

namespace plumbline {
namespace {

class StudySteps : public StudyNights {};

TEST_F(StudySteps, TrajectoriesComeFromACommandOrAPattern) {
  const fs::path data = ownData();
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

}  // namespace
}  // namespace plumbline
