// SPDX-License-Identifier: BSD-3-Clause
// The crossover's three estimates by hand (docs/study_statistics.md), and what is drawn at random
// where pairs are many.
#include "evaluate/statistics/paired_analysis.h"

#include <cmath>

#include <gtest/gtest.h>

namespace plumbline {
namespace {

// Began with the method: c = 2, 3 and sums of 4, 7. Began with the baseline: c = 0, -1, 4 and sums
// of 4, 3, 8.
const std::vector<PairedValues> kPairs{
    {1, 3, true}, {2, 5, true}, {2, 2, false}, {2, 1, false}, {2, 6, false}};

TEST(PairedAnalysis, EffectPeriodAndCarryOverAreThoseOfTheDefinition) {
  const PairedAnalysis a = analysePairs(kPairs, {});
  EXPECT_EQ(a.design, StudyDesign::kCrossover);
  EXPECT_EQ(a.first_method, 2);
  EXPECT_EQ(a.first_baseline, 3);
  EXPECT_DOUBLE_EQ(a.effect.estimate, (2.5 + 1) / 2);
  EXPECT_DOUBLE_EQ(a.period.value().estimate, (1 - 2.5) / 2);
  EXPECT_DOUBLE_EQ(a.carry_over.value().estimate, 5.5 - 5);
  EXPECT_DOUBLE_EQ(a.bca.value().estimate, a.effect.estimate) << "groups count alike";
  EXPECT_DOUBLE_EQ(a.signed_rank.hodges_lehmann, 1.5)
      << "the eighth of 15 Walsh averages of -1, 0, 2, 3, 4";
}

TEST(PairedAnalysis, TheSignedRanksIntervalIsOf95PerCent) {
  std::vector<PairedValues> pairs;
  std::vector<double> differences;
  for (int i = 0; i < 12; ++i) {
    const double d = 0.37 * i * i - 2 * i + 1;
    pairs.push_back({1, 1 + d, i % 2 == 0});
    differences.push_back(d);
  }
  const SignedRank expected = signedRank(differences, 0.95);
  const SignedRank found = analysePairs(pairs, {}).signed_rank;
  EXPECT_NEAR(found.low.value(), expected.low.value(), 1e-12);
  EXPECT_NEAR(found.high.value(), expected.high.value(), 1e-12);
}

// Equal figures may differ in their last digit: no sign is read into that, on any scale.
TEST(PairedAnalysis, ValuesThatDifferByTheirRoundingAreEqual) {
  std::vector<PairedValues> pairs;
  for (int i = 0; i < 12; ++i) {
    pairs.push_back(
        {30, i % 2 == 0 ? std::nextafter(30.0, 31) : std::nextafter(30.0, 29), i % 2 == 0});
  }
  const PairedAnalysis a = analysePairs(pairs, {});
  EXPECT_EQ(a.effect.estimate, 0);
  EXPECT_EQ(a.effect.p, 1);
  EXPECT_EQ(a.period.value().p, 1);
  EXPECT_EQ(a.signed_rank.p, 1);
}

// Drawn signs are a sample of all of them; the one that was observed is among them, so that no
// drawn p-value is 0 (Phipson and Smyth, 2010).
TEST(ShiftOfPairs, ThatIsDrawnComesNearToAllSigns) {
  const std::vector<double> d{1.2, -0.4, 0.9, 2.3, -1.3, 1.7, -0.6, 0.8, 1.1, -0.9, 0.3, 0.5};
  PermutationOptions drawn;
  drawn.enumerated_up_to = 10;
  const auto all = shiftOfPairs(d), some = shiftOfPairs(d, drawn);
  EXPECT_TRUE(all.exact);
  EXPECT_FALSE(some.exact);
  EXPECT_DOUBLE_EQ(some.permutations, 20'001);
  EXPECT_NEAR(some.p, all.p, 4 * 2 * std::sqrt(all.p / 2 / 2e4));
  EXPECT_NEAR(*some.low, *all.low, 0.05);
  EXPECT_NEAR(*some.high, *all.high, 0.05);
  const std::vector<double> one_way(20, 1.0);
  EXPECT_GT(shiftOfPairs(one_way, drawn).p, 0);
}

}  // namespace
}  // namespace plumbline
