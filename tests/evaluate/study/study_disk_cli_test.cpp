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
  EXPECT_THAT(outcome.text, HasSubstr("is no folder"));
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

}  // namespace
}  // namespace plumbline
