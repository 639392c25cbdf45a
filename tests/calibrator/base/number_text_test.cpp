// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "calibrator/base/option_check.h"

namespace plumbline {
namespace {

TEST(NegativeZeros, LoseTheirSign) {
  EXPECT_EQ(withoutNegativeZeros("-0"), "0");
  EXPECT_EQ(withoutNegativeZeros("(-0.000, -0.00) px, -0 s"), "(0.000, 0.00) px, 0 s");
  EXPECT_EQ(withoutNegativeZeros("\u22120.0 % ends in -0.0."), "0.0 % ends in 0.0.");
  EXPECT_EQ(withoutNegativeZeros(">-0.0000<"), ">0.0000<");
}

TEST(NegativeZeros, LeaveEverythingElse) {
  for (const char* text : {"-0.5", "-0.001", "-0.00010", "-0e-3", "cam-0", "1-0", "plot-0.0", "--0",
                           "2026-0", "0.0-0.5", "- 0", "-", "", "-0x1", "\u22120.25"}) {
    EXPECT_EQ(withoutNegativeZeros(text), text);
  }
}

}  // namespace
}  // namespace plumbline
