// SPDX-License-Identifier: BSD-3-Clause
// Lists and ranges of amounts on the command line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "evaluate/cli/options/option_lists.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(AmountList, TakesSignedAndFractionalNumbers) {
  EXPECT_THAT(amountsFrom("--x", "100,-3.21,+0.5,1e-3"), ElementsAre(100, -3.21, 0.5, 1e-3));
}

TEST(AmountList, RangesIncludeBothEndsInEitherDirection) {
  EXPECT_THAT(amountsFrom("--x", "-100:50:100"), ElementsAre(-100, -50, 0, 50, 100));
  EXPECT_THAT(amountsFrom("--x", "2:-1:0"), ElementsAre(2, 1, 0));
  EXPECT_THAT(amountsFrom("--x", "0.1:0.1:0.3"), ElementsAre(0.1, 0.2, 0.3));
  EXPECT_THAT(amountsFrom("--x", "1:2:4,7"), ElementsAre(1, 3, 7));
}

TEST(AmountList, RefusesEverythingElseByName) {
  // Twice the same amount would count twice.
  for (const char* words : {"100,100", "1,1.0", "0:1:3,2", "", "1,,2", "1,", "a", "1:2", "1:2:3:4",
                            "0:0:1", "0:-1:5", "nan", "inf", "1e9x", "0:1e-9:1", "1 2"}) {
    try {
      (void)amountsFrom("--offsets-ms", words);
      ADD_FAILURE() << words;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("--offsets-ms")) << words;
    }
  }
}

TEST(RelativeErrorsOption, IsAListWithoutEmptyParts) {
  EXPECT_EQ(relativeDeltasFrom("1m, 0.5s").size(), 2U);
  EXPECT_TRUE(relativeDeltasFrom("none").empty());
  for (const char* words : {"", ",", "1m,", ",1m", "1m,,2m", "1m,1.0m"}) {
    EXPECT_THROW(relativeDeltasFrom(words), InputError) << words;
  }
}

}  // namespace
}  // namespace plumbline
