// SPDX-License-Identifier: BSD-3-Clause
// Whose folder a night takes, and what it removes there of nights that were killed.
#include "evaluate/study/night_folder.h"

#include <filesystem>
#include <set>
#include <string>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include "datasets/files/bad_input.h"
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
