// SPDX-License-Identifier: BSD-3-Clause
// What all rules share: which side of a bound a value is on, and the largest standard deviation.
#include "evaluate/metrics/rules/rules.h"

#include <cmath>

#include <gtest/gtest.h>

namespace plumbline {
namespace {

const Rule kSmallIsGood{"error", "px", {1, 2}, "advice"};
const Rule kLargeIsGood{"views", "1", {20, 8}, "advice"};

// docs and options state bounds as "above" and "below": a value on its bound is within it. Beside a
// value stands the bound that it crossed, or the nearer one.
TEST(Rules, AValueOnItsBoundIsWithinIt) {
  const struct {
    bool large_is_good;
    double value;
    VerdictLevel level;
    double threshold;
  } cases[] = {
      {false, 1, VerdictLevel::kGood, 1},
      {false, std::nextafter(1.0, 2), VerdictLevel::kCaution, 1},
      {false, 2, VerdictLevel::kCaution, 1},
      {false, std::nextafter(2.0, 3), VerdictLevel::kBad, 2},
      {false, std::nan(""), VerdictLevel::kBad, 2},
      {true, 20, VerdictLevel::kGood, 20},
      {true, 19, VerdictLevel::kCaution, 20},
      {true, 8, VerdictLevel::kCaution, 20},
      {true, 7, VerdictLevel::kBad, 8},
      {true, std::nan(""), VerdictLevel::kBad, 8},
  };
  for (const auto& c : cases) {
    const Finding f =
        c.large_is_good ? below(kLargeIsGood, c.value, "") : above(kSmallIsGood, c.value, "");
    EXPECT_EQ(f.level, c.level) << f.rule << " " << c.value;
    EXPECT_EQ(f.threshold, c.threshold) << f.rule << " " << c.value;
    EXPECT_EQ(f.advice.empty(), c.level == VerdictLevel::kGood) << f.rule << " " << c.value;
  }
}

ParameterEstimate estimateOf(const std::string& name, double value, double formal) {
  return {name, value, formal, "px", {}, {}, {}};
}

TEST(Rules, OfAParametersThreeDeviationsTheLargestIsJudgedAndNamed) {
  ParameterEstimate f = estimateOf("cam0.fu", 500, 1);
  const auto largest = [&f] { return largestStd({f}, {"fu"}, "cam0.", false); };
  EXPECT_STREQ(largest().kind, "formal standard deviation");
  f.robust_std = 2;
  EXPECT_EQ(largest().value, 2);
  EXPECT_STREQ(largest().kind, "cluster-robust standard deviation");
  f.resample_std = 3;
  EXPECT_EQ(largest().value, 3);
  EXPECT_STREQ(largest().kind, "bootstrap std");
  f.std = 4;
  EXPECT_EQ(largest().value, 4);
  EXPECT_STREQ(largest().kind, "formal standard deviation");
}

// A relative deviation is one of a size: a parameter below zero is as uncertain as one above.
TEST(Rules, RelativeDeviationsHaveNoSign) {
  const std::vector<ParameterEstimate> estimates{estimateOf("cam0.fu", 500, 1),
                                                 estimateOf("cam0.fv", -100, 1)};
  const LargestStd largest = largestStd(estimates, {"fu", "fv"}, "cam0.", true);
  EXPECT_EQ(largest.name, "cam0.fv");
  EXPECT_DOUBLE_EQ(largest.value, 0.01);
}

TEST(Rules, OfNothingTheShareIsNone) {
  EXPECT_EQ(share(3, 12), 0.25);
  EXPECT_EQ(share(0, 0), 0);
}

}  // namespace
}  // namespace plumbline
