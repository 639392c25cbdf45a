// SPDX-License-Identifier: BSD-3-Clause
// p-values are those of R (coin, exactRankTests) and scipy; an interval holds the shifts that its
// own test does not reject; drawn permutations come near to all of them.
#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "evaluate/statistics/paired_analysis.h"
#include "tests/evaluate/statistics/reference_values.h"

namespace plumbline {
namespace {

using test::ReferenceValues;

std::string numbered(const char* name, int k) { return name + std::to_string(k); }

TEST(ShiftBetween, HasThePValueOfEveryPermutationInR) {
  const ReferenceValues r("r_values.txt");
  for (int k = 1; k <= 3; ++k) {
    const std::string name = numbered("between.", k);
    const auto result = shiftBetween(r.list(name + ".x"), r.list(name + ".y"));
    EXPECT_TRUE(result.exact);
    EXPECT_NEAR(result.p, r.number(name + ".p"), 1e-12) << k;
  }
}

// coin compares sums with a tolerance of 1e-8, by which its limits are off.
TEST(ShiftBetween, EndsItsIntervalWhereRsTestStopsRejecting) {
  const ReferenceValues r("r_values.txt");
  for (int k = 1; k <= 3; ++k) {
    const std::string name = numbered("between.", k);
    const auto result = shiftBetween(r.list(name + ".x"), r.list(name + ".y"));
    EXPECT_NEAR(result.low.value(), r.list(name + ".interval")[0], 1e-6) << k;
    EXPECT_NEAR(result.high.value(), r.list(name + ".interval")[1], 1e-6) << k;
  }
}

TEST(ShiftBetween, HasThePValueOfScipy) {
  const ReferenceValues scipy("scipy_values.txt");
  for (int k = 0; k < 3; ++k) {
    const std::string name = numbered("between.", k);
    const auto result = shiftBetween(scipy.list(name + ".x"), scipy.list(name + ".y"));
    EXPECT_NEAR(result.p, scipy.number(name + ".p"), 1e-12) << k;
  }
}

TEST(ShiftOfPairs, HasThePValueOfRAndOfScipy) {
  const ReferenceValues r("r_values.txt"), scipy("scipy_values.txt");
  for (int k = 1; k <= 3; ++k) {
    const std::string name = numbered("pairs.", k);
    EXPECT_NEAR(shiftOfPairs(r.list(name + ".d")).p, r.number(name + ".perm.p"), 1e-12) << k;
  }
  for (int k = 0; k < 3; ++k) {
    const std::string name = numbered("pairs.", k);
    EXPECT_NEAR(shiftOfPairs(scipy.list(name + ".d")).p, scipy.number(name + ".p"), 1e-12) << k;
  }
}

std::vector<double> shifted(std::vector<double> values, double by) {
  for (double& v : values) v += by;
  return values;
}

// By the definition: the test of x - delta against y is not rejected within, and is outside.
TEST(ShiftOfPairs, HoldsTheShiftsThatItsTestDoesNotReject) {
  const std::vector<double> d{1.2, -0.4, 0.9, 2.3, 0.2, 1.7, -0.1, 0.8, 1.1};
  const auto result = shiftOfPairs(d);
  const double step = 1e-9;
  EXPECT_LE(shiftOfPairs(shifted(d, -(*result.low - step))).p, 0.05);
  EXPECT_GT(shiftOfPairs(shifted(d, -(*result.low + step))).p, 0.05);
  EXPECT_GT(shiftOfPairs(shifted(d, -(*result.high - step))).p, 0.05);
  EXPECT_LE(shiftOfPairs(shifted(d, -(*result.high + step))).p, 0.05);
}

// With 5 pairs the least p-value is 2 / 32: nothing can be rejected at 5 %.
TEST(ShiftOfPairs, HasNoIntervalWhereNoShiftCanBeRejected) {
  const auto result = shiftOfPairs({1, 2, 3, 4, 5});
  EXPECT_DOUBLE_EQ(result.p, 2.0 / 32);
  EXPECT_FALSE(result.low || result.high);
  EXPECT_DOUBLE_EQ(result.permutations, 32);
}

TEST(ShiftBetween, CallsEqualSumsEqualWhateverTheirRounding) {
  EXPECT_DOUBLE_EQ(shiftBetween({0.1, 0.2, 0.3}, {0.3, 0.2, 0.1}).p, 1);
  EXPECT_DOUBLE_EQ(shiftBetween({0.7}, {0.1 + 0.6}).p, 1);
  EXPECT_DOUBLE_EQ(shiftBetween({0, 0, 0}, {0, 0, 0}).p, 1);
  EXPECT_DOUBLE_EQ(shiftOfPairs({0, 0, 0, 0, 0, 0, 0}).p, 1);
}

// 0.1 + 0.2 - 0.3 is 5.6e-17, which p takes for no shift at all.
TEST(ShiftOfPairs, EndsItsIntervalAtNoShiftButForRounding) {
  const auto result = shiftOfPairs({0.1 + 0.2 - 0.3, 1, 2, 3, 4, 5});
  EXPECT_GT(result.p, 0.05);
  EXPECT_EQ(result.low.value(), 0);
}

TEST(Permutations, ThatAreDrawnComeNearToAllOfThem) {
  const std::vector<double> x{0.9, 1.4, 0.1, 1.1, 0.8, 2.0, 0.6, 1.9},
      y{0.2, 0.3, 1.2, -0.4, 0.9, 0.1, 0.5, 0.0};
  PermutationOptions drawn;
  drawn.enumerated_up_to = 10;
  const auto all = shiftBetween(x, y), some = shiftBetween(x, y, drawn);
  EXPECT_TRUE(all.exact);
  EXPECT_FALSE(some.exact);
  EXPECT_DOUBLE_EQ(some.permutations, 20'001);
  const double sigma = std::sqrt(all.p / 2 / 2e4) * 2;  // of a binomial share, doubled
  EXPECT_NEAR(some.p, all.p, 4 * sigma);
  EXPECT_NEAR(*some.low, *all.low, 0.02);
  EXPECT_NEAR(*some.high, *all.high, 0.02);
  EXPECT_EQ(shiftBetween(x, y, drawn).p, some.p) << "the seed decides";
}

TEST(PermutationOptions, NameAFieldOutOfItsRange) {
  PermutationOptions options;
  options.confidence = 1;
  EXPECT_THROW(options.check(), InputError);
  options = {};
  options.drawn = 0;
  EXPECT_THROW(options.check(), InputError);
}

}  // namespace
}  // namespace plumbline
