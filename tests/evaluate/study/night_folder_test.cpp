// SPDX-License-Identifier: BSD-3-Clause
// Whose folder a night takes, and what it removes there of nights that were killed.
#include "evaluate/study/night_folder.h"

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/inotify.h>
#include <sys/wait.h>
#include <unistd.h>

#include "datasets/files/bad_input.h"
#include "datasets/files/workplace.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

class NightFolder : public testing::Test {
 protected:
  static StudyDefinition study(const std::string& name) {
    StudyDefinition definition;
    definition.name = name;
    return definition;
  }
  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_.path())) {
      names.insert(entry.path().filename().string());
    }
    return names;
  }

  TemporaryFolder folder_;
};

// A kill may leave nothing but the half-written mark, which no later night may take for a foreign
// file, and after that any of the files that are written under a temporary name.
TEST_F(NightFolder, WhatAKilledNightWasWritingIsRemoved) {
  folder_.write("plumbline-study.json.partial-dEAd01", "{\"prog");
  takeNightFolder(folder_.path(), study("a"));
  folder_.write("plan.jsonl.partial-dEAd02", "half");
  folder_.write("sessions/p1/.calibrate.partial-dEAd03/lock", "");
  removeLeftovers(folder_.path());
  EXPECT_EQ(files(), (std::set<std::string>{"plumbline-study.json", "sessions"}));
  EXPECT_TRUE(fs::is_empty(fs::path(folder_.path()) / "sessions/p1"));
}

// Of a recording that was taken out of the study, say: no plan names its steps.
TEST_F(NightFolder, HalfResultsOfStepsThatAreNoLongerPlannedAreRemoved) {
  folder_.write("recordings/gone/.detect.partial-dEAd03/lock", "");
  folder_.write("recordings/gone/detect/result.txt", "whole");
  removeLeftovers(folder_.path());
  EXPECT_FALSE(fs::exists(folder_.path("recordings/gone/.detect.partial-dEAd03")));
  EXPECT_TRUE(fs::exists(folder_.path("recordings/gone/detect/result.txt")));
}

TEST_F(NightFolder, AResultThatWasMovedAsideIsPutBackAndForeignFoldersStay) {
  folder_.write("sessions/p1/.calibrate.partial-dEAd03/lock", "plumbline\nfor calibrate\n");
  folder_.write("sessions/p1/.calibrate.partial-dEAd03/old/step.json", "{}");
  folder_.write("sessions/p1/.calibrate.partial-dEAd03/log.txt", "of its command");
  folder_.write("sessions/p1/.notes.partial-mine", "mine");
  folder_.write("sessions/p1/.calibrate.partial-notYet/result", "no lock as yet");
  removeLeftovers(folder_.path());
  EXPECT_TRUE(fs::exists(folder_.path("sessions/p1/calibrate/step.json")));
  EXPECT_FALSE(fs::exists(folder_.path("sessions/p1/.calibrate.partial-dEAd03")));
  EXPECT_TRUE(fs::exists(folder_.path("sessions/p1/.notes.partial-mine")));
  EXPECT_TRUE(fs::exists(folder_.path("sessions/p1/.calibrate.partial-notYet/result")));
}

TEST_F(NightFolder, PlacesThatCannotBeReadAreLeftAlone) {
  folder_.write("sessions/closed/.calibrate.partial-dEAd01/lock", "");
  folder_.write("sessions/p1/.calibrate.partial-dEAd02/lock", "");
  folder_.write("sessions/notes.txt", "no folder");
  const fs::path sessions = fs::path(folder_.path()) / "sessions";
  fs::create_directory_symlink("gone", sessions / "link");
  fs::permissions(sessions / "closed", fs::perms::none);
  const bool readable = access((sessions / "closed").c_str(), R_OK) == 0;  // as root
  removeLeftovers(folder_.path());
  fs::permissions(sessions / "closed", fs::perms::owner_all);
  EXPECT_TRUE(fs::is_empty(sessions / "p1"));
  EXPECT_EQ(fs::is_empty(sessions / "closed"), readable);
  EXPECT_TRUE(fs::exists(sessions / "notes.txt"));
}

// Killed while it removes what another left: what it did not come to is still known for stale.
TEST_F(NightFolder, RemovingThatIsKilledIsTakenUpByTheNextNight) {
  const std::string workplace = "sessions/p1/.calibrate.partial-dEAd01/";
  bool half = false;
  for (int attempt = 0; attempt < 100 && !half; ++attempt) {
    for (int i = 0; i < 2000; ++i) folder_.write(workplace + std::to_string(i), "");
    folder_.write(workplace + "lock", "plumbline\nfor calibrate\n");
    const int deletions = inotify_init1(IN_CLOEXEC);
    ASSERT_GE(inotify_add_watch(deletions, folder_.path(workplace).c_str(), IN_DELETE), 0);
    const pid_t pid = fork();
    if (pid == 0) {
      removeLeftovers(folder_.path());
      _exit(0);
    }
    char event[sizeof(inotify_event) + 16];  // room for one with a short name
    for (int deleted = 0; deleted < 1500; ++deleted) {
      ASSERT_GT(read(deletions, event, sizeof event), 0);
    }
    kill(pid, SIGKILL);
    waitpid(pid, nullptr, 0);
    close(deletions);
    half = fs::exists(folder_.path(workplace));
    removeLeftovers(folder_.path());
    EXPECT_TRUE(fs::is_empty(fs::path(folder_.path()) / "sessions/p1"));
  }
  EXPECT_TRUE(half);
}

// A command outlives the process that ran it by a moment, and writes on.
TEST_F(NightFolder, AWorkplaceStaysUntilTheProgramThatWasRunInItIsDead) {
  int said[2];
  ASSERT_EQ(pipe(said), 0);
  const fs::path step = fs::path(folder_.path()) / "sessions/p1/calibrate";
  const pid_t pid = fork();
  if (pid == 0) {
    const Workplace workplace(step, step.string());
    if (fork() == 0) {
      dup2(said[1], STDOUT_FILENO);
      execlp("sh", "sh", "-c", "echo $$; exec sleep 100", nullptr);
    }
    pause();
  }
  char text[32] = "";
  ASSERT_GT(read(said[0], text, sizeof text - 1), 0);
  kill(pid, SIGKILL);
  waitpid(pid, nullptr, 0);
  removeLeftovers(folder_.path());
  EXPECT_FALSE(fs::is_empty(step.parent_path()));
  kill(std::atoi(text), SIGKILL);
  for (int ms = 0; ms < 10000 && !fs::is_empty(step.parent_path()); ++ms) {
    usleep(1000);
    removeLeftovers(folder_.path());
  }
  EXPECT_TRUE(fs::is_empty(step.parent_path()));
  close(said[0]);
  close(said[1]);
}

TEST_F(NightFolder, WhatALiveProcessWritesStays) {
  folder_.write("summary.json.partial-aLIve1", "half");
  const int file = open(folder_.path("summary.json.partial-aLIve1").c_str(), O_RDONLY);
  ASSERT_EQ(flock(file, LOCK_EX | LOCK_NB), 0);
  removeLeftovers(folder_.path());
  EXPECT_EQ(files(), (std::set<std::string>{"summary.json.partial-aLIve1"}));
  close(file);
  removeLeftovers(folder_.path());
  EXPECT_TRUE(files().empty());
}

TEST_F(NightFolder, ForeignFilesAndOtherStudiesAreRefusedAndStay) {
  for (const char* foreign : {"thesis.tex", "plumbline-study.json.partial-", "x.partial-dEAd01"}) {
    folder_.write(foreign, "mine");
    EXPECT_EQ(faultOf([&] { takeNightFolder(folder_.path(), study("a")); }),
              InputFault::kForeignFiles);
    EXPECT_EQ(files(), (std::set<std::string>{foreign}));
    fs::remove(folder_.path(foreign));
  }
  takeNightFolder(folder_.path(), study("a"));
  takeNightFolder(folder_.path(), study("a"));
  EXPECT_EQ(faultOf([&] { takeNightFolder(folder_.path(), study("b")); }),
            InputFault::kForeignFiles);
}

}  // namespace
}  // namespace plumbline
