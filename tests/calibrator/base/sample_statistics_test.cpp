// SPDX-License-Identifier: BSD-3-Clause
// Statistics of scalar errors, by hand.
#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/base/statistics.h"

namespace plumbline {
namespace {

TEST(SampleStatistics, ByHand) {
  const SampleStatistics s = sampleStatistics({3, 1, 4, 2});
  EXPECT_EQ(s.n, 4U);
  EXPECT_DOUBLE_EQ(s.sse, 30);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(s.mean, 2.5);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.std, std::sqrt(1.25));
  EXPECT_DOUBLE_EQ(s.min, 1);
  EXPECT_DOUBLE_EQ(s.max, 4);
  EXPECT_DOUBLE_EQ(s.percentiles[2], 1.75);  // 25 %
  EXPECT_DOUBLE_EQ(s.percentiles[5], 3.97);  // 99 %
}

TEST(SampleStatistics, TheUnbiasedVarianceDividesByOneLess) {
  EXPECT_DOUBLE_EQ(sampleStatistics({3, 1, 4, 2}, 1).std, std::sqrt(5.0 / 3));
  EXPECT_EQ(sampleStatistics({3}, 1).std, 0);
}

TEST(SampleStatistics, TheSquareOfTheRmseIsThatOfMeanAndSpread) {
  const SampleStatistics s = sampleStatistics({0.1, -7, 2, 2, 40, 3e-3});
  EXPECT_NEAR(s.rmse * s.rmse, s.mean * s.mean + s.std * s.std, 1e-12);
}

TEST(SampleStatistics, OfNothingAreZero) {
  const SampleStatistics s = sampleStatistics({});
  EXPECT_EQ(s.n, 0U);
  EXPECT_EQ(s.max, 0);
}

}  // namespace
}  // namespace plumbline
