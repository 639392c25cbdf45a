// SPDX-License-Identifier: BSD-3-Clause
// Folders that cannot be written, and a disk that is full.
#include "tests/evaluate/study/study_nights.h"

namespace plumbline {
namespace {

class StudyDisk : public StudyNights {};

TEST_F(StudyDisk, AnOutputThatCannotBeWrittenIsNamed) {
  EXPECT_EQ(study(root_ / "data", "/proc/night").exit_code, 2);
  write(scratch_ / "file", "");
  const Outcome outcome = study(root_ / "data", scratch_ / "file");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.text, HasSubstr("is not a folder"));
}

// From the n-th write of every process on there is no space.
TEST_F(StudyDisk, AFullDiskEndsTheNightAndLosesNothing) {
  for (const int n : {1, 4, 12}) {
    const fs::path night = scratch_ / std::to_string(n);
    const Outcome full = shell(
        "ASAN_OPTIONS=verify_asan_link_order=0 LD_PRELOAD=" + std::string(PLUMBLINE_FAILING_CALLS) +
        " PLUMBLINE_FULL_AT=" + std::to_string(n) + " " + PLUMBLINE_BINARY + " " +
        words(root_ / "data", night));
    EXPECT_EQ(full.exit_code, 2) << full.text;
    EXPECT_THAT(full.text,
                testing::AnyOf(HasSubstr("No space left on device"), HasSubstr("disk is full")));
    const Outcome again = study(root_ / "data", night);
    EXPECT_EQ(again.exit_code, 0) << again.text;
    EXPECT_EQ(values(night), values(root_ / "undisturbed")) << n;
  }
}

// A real file system of a few megabytes, where this user may mount one. The night does what finds
// room, says of the rest why not, and the next one, with room, does only that. One step at a time:
// of two that end together, each may take the room that the other needs, and neither is done.
TEST_F(StudyDisk, ASmallFileSystemThatFillsUpLosesNothing) {
  if (shell("unshare -rm mount -t tmpfs none " + scratch_.string()).exit_code != 0) {
    GTEST_SKIP() << "a file system cannot be mounted here (unshare -rm): not tested";
  }
  const fs::path disk = scratch_ / "disk", kept = scratch_ / "kept";
  fs::create_directories(disk);
  fs::create_directories(kept);
  const std::string night = (disk / "night").string();
  const std::string run =
      std::string(PLUMBLINE_BINARY) + " " + words(root_ / "data", night) + " --jobs 1";
  write(scratch_ / "run.sh",
        "set -e\n"
        "mount -t tmpfs -o size=3m none " +
            disk.string() +
            "\n"
            "cd " +
            kept.string() + "\n" + run +
            " >first.txt 2>&1 || true\n"
            "find " +
            night +
            " -path '*.partial*' >leftovers.txt\n"
            "find " +
            night +
            " -name step.json | xargs grep -l '\"status\": \"done\"' | "
            "xargs stat -c '%n %y' >done_first.txt\n"
            "mount -o remount,size=300m " +
            disk.string() + "\n" + run +
            " >second.txt 2>&1\n"
            "cut -d' ' -f1 done_first.txt | xargs stat -c '%n %y' >done_second.txt\n"
            "cp " +
            night + "/study.sqlite .\n");
  const Outcome outcome = shell("unshare -rm sh " + (scratch_ / "run.sh").string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text << read(kept / "second.txt");
  EXPECT_THAT(read(kept / "first.txt"), HasSubstr("No space left on device"));
  EXPECT_EQ(read(kept / "leftovers.txt"), "");
  EXPECT_THAT(read(kept / "second.txt"), HasSubstr("4 of 4 sessions have a calibration"));
  EXPECT_NE(read(kept / "done_first.txt"), "");
  EXPECT_EQ(read(kept / "done_first.txt"), read(kept / "done_second.txt")) << "done again";
  EXPECT_EQ(values(kept, FirstNights::kIgnore),
            values(root_ / "undisturbed", FirstNights::kIgnore));
}

}  // namespace
}  // namespace plumbline
