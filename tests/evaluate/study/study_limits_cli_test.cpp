// SPDX-License-Identifier: BSD-3-Clause
// Steps beyond their limits of time and memory.
#include "tests/evaluate/study/study_nights.h"

namespace plumbline {
namespace {

class StudyLimits : public StudyNights {
 protected:
  // The study with an estimate for each of its four calibrations, made by this command.
  fs::path dataWith(const std::string& command, const std::string& limits = "") const {
    const fs::path data = ownData();
    write(data / "STUDY.yaml",
          read(data / "STUDY.yaml") +
              "sequences: [{name: s, path: eval, truth: eval/truth/trajectory.csv}]\n"
              "trajectories: {command: '" +
              command + "'}\n" + limits);
    return data;
  }
};

TEST_F(StudyLimits, AStepBeyondItsTimeEndsWithAllThatItStarted) {
  const std::string seconds = "9" + std::to_string(getpid());  // no other test's
  const fs::path data = dataWith("sleep " + seconds + " & sleep " + seconds + "; echo {out}",
                                 "limits: {step_s: 2}\n");
  const Outcome outcome = study(data, doneNight(), "--jobs 4");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  const auto summary = nlohmann::json::parse(read(scratch_ / "night/summary.json"));
  ASSERT_EQ(summary.at("trajectories").size(), 4u);
  EXPECT_THAT(summary.at("trajectories")[0].at("failure").get<std::string>(),
              HasSubstr("not done after 2 s"));
  EXPECT_NE(std::system(("pgrep -f 'sleep [9]" + seconds.substr(1) + "' >/dev/null").c_str()), 0)
      << "left running";
}

// By hand, or by a scheduler: its process alone gets the signal, while what it runs writes on.
TEST_F(StudyLimits, AStepThatIsEndedBySigtermLeavesNothing) {
  const fs::path writes = scratch_ / "writes";
  const fs::path data =
      dataWith("(while :; do mkdir -p {out}/a; echo > {out}/a/$(date +%N); touch " +
               writes.string() + "; done) | cat");
  const std::string commands = study(data, doneNight(), "--engine commands").text;
  const std::size_t at = commands.find(" sessions/p1_free/estimate");
  ASSERT_NE(at, std::string::npos) << commands;
  const std::string step = commands.substr(at + 1, commands.find_first_of(" \n", at + 1) - at - 1);
  const fs::path folder = (scratch_ / "night" / step).parent_path();
  const auto partial = [&] {
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (entry.path().string().find(".partial-") != std::string::npos) return entry.path();
    }
    return fs::path();
  };
  const pid_t pid = start("study run-step " + (scratch_ / "night").string() + " " + step);
  for (int i = 0; i < 2000 && !fs::exists(writes); ++i) usleep(10'000);
  EXPECT_NE(partial(), fs::path());
  kill(pid, SIGTERM);
  int status = 0;
  waitpid(pid, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 128 + SIGTERM);
  usleep(200'000);
  EXPECT_EQ(partial(), fs::path());
}

TEST_F(StudyLimits, WhatAStepStartedEndsWithANightThatIsKilled) {
  for (const int signal : {SIGKILL, SIGTERM}) {
    // Another folder each: in that of a night that was killed steps may still remove what is
    // theirs.
    scratch_ /= std::to_string(signal);
    fs::create_directories(scratch_);
    const std::string seconds = std::to_string(signal) + std::to_string(getpid());
    const fs::path data = dataWith("sleep " + seconds + " | cat; echo {out}");
    const pid_t pid = start(words(data, doneNight()));
    const auto left = [&] {
      return std::system(("pgrep -f '^sleep " + seconds + "$' >/dev/null").c_str()) == 0;
    };
    for (int i = 0; i < 400 && !left(); ++i) usleep(50'000);
    EXPECT_TRUE(left());
    kill(pid, signal);
    waitpid(pid, nullptr, 0);
    for (int i = 0; i < 60 && left(); ++i) usleep(50'000);
    EXPECT_FALSE(left()) << signal;
    scratch_ = scratch_.parent_path();
  }
}

// By the message, which opens with the file: by its final name, as this program has it, or not.
TEST_F(StudyLimits, AStepThatCannotWriteItsResultIsLostAndIsTriedAgain) {
  const fs::path data = dataWith(
      "echo {out}/x: no room | sed \"s#/[.]\\([^/]*\\)[.]partial-[^/]*/result#/\\1#\"; exit 2");
  const fs::path night = doneNight();
  EXPECT_THAT(study(data, night).text, HasSubstr("no room"));
  const auto once = times(night);
  EXPECT_EQ(study(data, night).exit_code, 0);
  EXPECT_EQ(doneAgain(once, night).size(), 4U) << "the estimates of four sessions";
}

// As some daemons and wrappers start programs: a child that ended could not be waited for.
TEST_F(StudyLimits, WhereSigchldIsIgnoredStepsAreWaitedForAllTheSame) {
  const Outcome outcome =
      shell("timeout 300 bash -c \"trap '' CHLD; exec " + std::string(PLUMBLINE_BINARY) + " " +
            words(root_ / "data", scratch_ / "night") + "\"");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
}

TEST_F(StudyLimits, AStepBeyondItsMemoryFailsAlone) {
  const fs::path data = dataWith("head -c 1G /dev/zero | tail", "limits: {step_mb: 600}\n");
  const Outcome outcome = study(data, scratch_ / "night");
  EXPECT_THAT(outcome.text, HasSubstr("4 of 4 sessions have a calibration"));
  const auto summary = nlohmann::json::parse(read(scratch_ / "night/summary.json"));
  EXPECT_THAT(summary.at("trajectories")[0].at("failure").get<std::string>(),
              HasSubstr("memory exhausted"));
}

}  // namespace
}  // namespace plumbline
