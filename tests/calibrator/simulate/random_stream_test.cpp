// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/random_stream.h"

#include <array>
#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

namespace plumbline {
namespace {

TEST(RandomStream, SameArgumentsGiveTheSameNumbers) {
  RandomStream a(7, RandomPurpose::kCornerNoise, {1, 2});
  RandomStream b(7, RandomPurpose::kCornerNoise, {1, 2});
  for (int i = 0; i < 100; ++i) ASSERT_EQ(a.normal(), b.normal());
}

TEST(RandomStream, NeighboursShareNothing) {
  const auto first = [](std::uint64_t seed, RandomPurpose purpose,
                        std::initializer_list<std::uint64_t> indices) {
    return RandomStream(seed, purpose, indices).uniform();
  };
  const double reference = first(7, RandomPurpose::kCornerNoise, {1, 2});
  EXPECT_NE(reference, first(8, RandomPurpose::kCornerNoise, {1, 2}));
  EXPECT_NE(reference, first(7, RandomPurpose::kOutliers, {1, 2}));
  EXPECT_NE(reference, first(7, RandomPurpose::kCornerNoise, {2, 1}));
  EXPECT_NE(reference, first(7, RandomPurpose::kCornerNoise, {1}));
}

// The bounds are 5 standard errors of the sample moments of n draws.
TEST(RandomStream, NormalHasTheMomentsOfAStandardNormal) {
  RandomStream random(1, RandomPurpose::kGyroNoise);
  constexpr int kDraws = 200000;
  double sum = 0, sum2 = 0, sum3 = 0, sum4 = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.normal();
    sum += x;
    sum2 += x * x;
    sum3 += x * x * x;
    sum4 += x * x * x * x;
  }
  const double error = 5 / std::sqrt(kDraws);
  EXPECT_NEAR(sum / kDraws, 0, error);
  EXPECT_NEAR(sum2 / kDraws, 1, error * std::sqrt(2.0));
  EXPECT_NEAR(sum3 / kDraws, 0, error * std::sqrt(15.0));
  EXPECT_NEAR(sum4 / kDraws, 3, error * std::sqrt(96.0));
}

TEST(RandomStream, UniformFillsItsIntervalEvenly) {
  RandomStream random(1, RandomPurpose::kOutliers);
  constexpr int kBins = 16;
  constexpr int kDraws = 160000;
  std::array<int, kBins> count{};
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.uniform(-1, 3);
    ASSERT_GE(x, -1);
    ASSERT_LT(x, 3);
    ++count[static_cast<std::size_t>((x + 1) / 4 * kBins)];
  }
  double chi2 = 0;
  const double expected = static_cast<double>(kDraws) / kBins;
  for (const int c : count) chi2 += (c - expected) * (c - expected) / expected;
  EXPECT_LT(chi2, 37.7);  // 99.9 % quantile of chi-square with 15 degrees of freedom
}

}  // namespace
}  // namespace plumbline
