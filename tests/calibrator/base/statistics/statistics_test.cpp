// SPDX-License-Identifier: BSD-3-Clause
// Statistics of errors in the image and of scalar ones, by hand.
#include "calibrator/base/statistics/statistics.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace plumbline {
namespace {

TEST(ErrorStatistics, ByHand) {
  // Lengths 5, 0, 13, 5, 2.
  const ErrorStatistics s = summariseErrors({{3, 4}, {0, 0}, {-5, 12}, {-4, 3}, {0, -2}});
  EXPECT_EQ(s.count, 5U);
  EXPECT_DOUBLE_EQ(s.rmse_px, std::sqrt((25 + 0 + 169 + 25 + 4) / 5.0));
  EXPECT_DOUBLE_EQ(s.mean_px, 5);
  EXPECT_DOUBLE_EQ(s.median_px, 5);
  EXPECT_DOUBLE_EQ(s.std_px, std::sqrt((0 + 25 + 64 + 0 + 9) / 5.0));
  EXPECT_NEAR(s.rmse_px * s.rmse_px, s.mean_px * s.mean_px + s.std_px * s.std_px, 1e-12);
  EXPECT_NEAR(s.axis_mean_px.x(), -1.2, 1e-15);
  EXPECT_NEAR(s.axis_mean_px.y(), 3.4, 1e-15);
  EXPECT_NEAR(s.axis_std_px.x(), std::sqrt((9 + 25 + 16) / 5.0 - 1.44), 1e-14);
}

TEST(ErrorStatistics, OfNothingAreZero) {
  const ErrorStatistics s = summariseErrors({});
  EXPECT_EQ(s.count, 0U);
  EXPECT_EQ(s.rmse_px, 0);
}

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

TEST(Quantile, InterpolatesBetweenNeighboursAndNeedsNoneOnAValue) {
  EXPECT_DOUBLE_EQ(quantile({4, 1, 3, 2}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantile({4, 1, 3, 2}, 0.25), 1.75);
  EXPECT_DOUBLE_EQ(quantile({4, 1, 3, 2}, 0.9), 3.7);
  EXPECT_DOUBLE_EQ(quantile({4, 1, 3, 2}, 0), 1);
  EXPECT_DOUBLE_EQ(quantile({4, 1, 3, 2}, 1), 4);
  EXPECT_DOUBLE_EQ(quantile({5}, 0.9), 5);
  const double never = std::numeric_limits<double>::infinity();
  EXPECT_DOUBLE_EQ(quantile({never, 1, 2}, 0.5), 2);
  EXPECT_EQ(quantile({never, never, 1}, 0.5), never);
  EXPECT_EQ(quantile({never, never, 1}, 0.75), never);
}

TEST(MiddleOf, IsTheUpperOfTwo) {
  EXPECT_EQ(middleOf(std::vector<std::int64_t>{7, 1, 4}), 4);
  EXPECT_EQ(middleOf(std::vector<std::int64_t>{7, 1, 4, 2}), 4);
}

TEST(IsLarger, WhatIsNoNumberIsTheLargestWhereverItStands) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const std::vector<double>& values :
       {std::vector{nan, 1.0, 3.0}, {1.0, nan, 3.0}, {1.0, 3.0, nan}}) {
    double largest = 0;
    for (const double v : values) {
      if (isLarger(v, largest)) largest = v;
    }
    EXPECT_TRUE(std::isnan(largest));
  }
  EXPECT_TRUE(isLarger(2, 1));
  EXPECT_FALSE(isLarger(1, 1));
  EXPECT_FALSE(isLarger(1, 2));
}

}  // namespace
}  // namespace plumbline
