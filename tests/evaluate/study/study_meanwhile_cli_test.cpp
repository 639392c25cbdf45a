// SPDX-License-Identifier: BSD-3-Clause
// What others do while a night is at work.
#include <thread>

#include "tests/evaluate/study/study_nights.h"

namespace plumbline {
namespace {

class StudyMeanwhile : public StudyNights {};

TEST_F(StudyMeanwhile, ASecondNightSaysSoAndLeaves) {
  const fs::path night = scratch_ / "night";
  const pid_t first = start(words(root_ / "data", night));
  while (!fs::exists(night / "plan.jsonl")) std::this_thread::yield();
  const Outcome second = study(root_ / "data", night);
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.text,
              HasSubstr("another night is running here: process " + std::to_string(first)));
  int status = 0;
  waitpid(first, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(values(night), values(root_ / "undisturbed"));
}

TEST_F(StudyMeanwhile, ASessionChangedMeanwhileIsReadAgainTheNextNight) {
  const fs::path data = ownData(), night = scratch_ / "night";
  const pid_t pid = start(words(data, night) + " --jobs 1");
  while (!fs::exists(night / "plan.jsonl")) std::this_thread::yield();
  // The plan is of the older state: whatever step reads this next must say so.
  for (const char* name : {"p1_free", "p1_guided", "p2_free", "p2_guided"}) {
    write(data / name / "mav0/note.txt", "changed");
  }
  int status = 0;
  waitpid(pid, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  std::set<std::string> changed;
  for (const StudyStepRow& step : StudyStore(night / "study.sqlite").steps()) {
    if (step.status != "changed") continue;
    EXPECT_THAT(step.message, testing::AllOf(HasSubstr(data.string()), HasSubstr("changed ")));
    changed.insert(step.name);
  }
  EXPECT_FALSE(changed.empty());
  const auto before = times(night);
  const Outcome next = study(data, night);
  EXPECT_THAT(next.text, HasSubstr("4 of 4 sessions have a calibration"));
  const std::set<std::string> again = doneAgain(before, night);
  for (const std::string& name : changed) EXPECT_EQ(again.count(name), 1) << name;
}

// The program may be replaced while a night runs: it goes on as it began.
TEST_F(StudyMeanwhile, AnotherBuildUnderTheSameNameMeanwhileChangesNothing) {
  const fs::path program = scratch_ / "plumbline";
  fs::copy_file(PLUMBLINE_BINARY, program);
  const fs::path night = scratch_ / "night";
  const pid_t pid = fork();
  if (pid == 0) {
    execl("/bin/sh", "sh", "-c",
          ("exec " + program.string() + " " + words(root_ / "data", night) + " >/dev/null 2>&1")
              .c_str(),
          nullptr);
    _exit(127);
  }
  while (!fs::exists(night / "plan.jsonl")) std::this_thread::yield();
  fs::remove(program);
  write(program, "#!/bin/sh\nexit 1\n");
  int status = 0;
  waitpid(pid, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(values(night), values(root_ / "undisturbed"));
}

}  // namespace
}  // namespace plumbline
