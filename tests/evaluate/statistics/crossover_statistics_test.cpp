// SPDX-License-Identifier: BSD-3-Clause
// Many made-up crossovers: the test rejects no effect as often as it says, whatever the period's
// effect, and the interval holds the true one as often as it says.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "evaluate/statistics/paired_analysis.h"

namespace plumbline {
namespace {

constexpr int kStudies = 2000;
constexpr double kEffect = -0.3, kPeriod = -0.8;

/// Skewed noise: the test assumes no distribution.
double skewed(std::mt19937_64& random) {
  const double uniform = (static_cast<double>(random() >> 11U) + 0.5) / 9007199254740992.0;
  return -std::log(uniform);
}

std::vector<PairedValues> crossover(double effect, std::mt19937_64& random) {
  std::vector<PairedValues> pairs;
  for (int i = 0; i < 10; ++i) {
    const bool method_first = i >= 4;  // not quite balanced
    const double level = 3 * skewed(random);
    const double baseline = level + skewed(random) + (method_first ? kPeriod : 0);
    const double method = level + effect + skewed(random) + (method_first ? 0 : kPeriod);
    pairs.push_back({baseline, method, method_first});
  }
  return pairs;
}

PairedOptions quick() {
  PairedOptions options;
  options.bootstrap.resamples = 100;
  return options;
}

// 210 ways to deal out the orders: p-values are coarse, so rejections may be rarer than 5 %.
// Four deviations of a binomial share over 2000 studies are 2 %.
TEST(CrossoverStatistics, RejectsNoEffectAsOftenAsStated) {
  std::mt19937_64 random(1);
  int rejected = 0;
  for (int k = 0; k < kStudies; ++k) {
    rejected += analysePairs(crossover(0, random), quick()).effect.p <= 0.05 ? 1 : 0;
  }
  EXPECT_LE(rejected, 0.07 * kStudies);
  EXPECT_GE(rejected, 0.025 * kStudies);
}

TEST(CrossoverStatistics, HoldsTheTrueEffectsAsOftenAsStated) {
  std::mt19937_64 random(2);
  int effects = 0, periods = 0;
  double mean = 0;
  const auto holds = [](const PermutationResult& r, double truth) {
    return *r.low <= truth && truth <= *r.high ? 1 : 0;
  };
  for (int k = 0; k < kStudies; ++k) {
    const PairedAnalysis a = analysePairs(crossover(kEffect, random), quick());
    effects += holds(a.effect, kEffect);
    periods += holds(*a.period, kPeriod);
    mean += a.effect.estimate / kStudies;
  }
  EXPECT_GE(effects, 0.93 * kStudies);
  EXPECT_LE(effects, 0.985 * kStudies);
  EXPECT_GE(periods, 0.93 * kStudies);
  // The noise of a difference is sqrt(2); of the estimate sqrt(2) / 2 sqrt(1/4 + 1/6) = 0.46.
  EXPECT_NEAR(mean, kEffect, 4 * 0.46 / std::sqrt(kStudies));
}

}  // namespace
}  // namespace plumbline
