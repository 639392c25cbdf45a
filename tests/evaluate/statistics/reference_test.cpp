// SPDX-License-Identifier: BSD-3-Clause
// Signed ranks, bootstrap, Holm, Quade and Kaplan-Meier give what R and scipy give.
#include <algorithm>
#include <cmath>
#include <random>

#include <boost/math/distributions/normal.hpp>
#include <gtest/gtest.h>

#include "evaluate/statistics/paired_analysis.h"
#include "evaluate/statistics/several_tests.h"
#include "tests/evaluate/statistics/reference_values.h"

namespace plumbline {
namespace {

using test::ReferenceValues;

TEST(SignedRank, IsExactAlsoWithTies) {
  const ReferenceValues r("r_values.txt");
  for (int k = 1; k <= 3; ++k) {
    const std::string name = "pairs." + std::to_string(k);
    const SignedRank result = signedRank(r.list(name + ".d"));
    EXPECT_DOUBLE_EQ(result.statistic, r.number(name + ".wilcoxon.v")) << k;
    EXPECT_NEAR(result.p, r.number(name + ".wilcoxon.p"), 1e-12) << k;
  }
  const ReferenceValues scipy("scipy_values.txt");
  for (int k = 0; k < 3; ++k) {
    const std::string name = "pairs." + std::to_string(k);
    EXPECT_NEAR(signedRank(scipy.list(name + ".d")).p, scipy.number(name + ".wilcoxon.p"), 1e-12);
  }
}

TEST(SignedRank, HasHodgesAndLehmannsEstimateAndInterval) {
  const ReferenceValues r("r_values.txt");
  for (const int n : {6, 9, 16}) {
    const std::string name = "walsh." + std::to_string(n);
    const SignedRank result = signedRank(r.list(name + ".d"));
    EXPECT_NEAR(result.p, r.number(name + ".p"), 1e-12);
    EXPECT_NEAR(result.hodges_lehmann, r.number(name + ".estimate"), 1e-9);
    EXPECT_NEAR(result.low.value(), r.list(name + ".interval")[0], 1e-9);
    EXPECT_NEAR(result.high.value(), r.list(name + ".interval")[1], 1e-9);
  }
  EXPECT_FALSE(signedRank({1, 2, 3, 4, 5}).low) << "2 / 32 is above 5 %";
}

TEST(SignedRank, LeavesOutDifferencesOfZero) {
  EXPECT_DOUBLE_EQ(signedRank({0, 1, 2, 3}).p, signedRank({1, 2, 3}).p);
  EXPECT_DOUBLE_EQ(signedRank({0, 0}).p, 1);
}

// 0, 0.5, 1, 1, 1.5, 1.5, 2, 2, 2.5, 3 are the averages; without the zero their median would be 2.
TEST(SignedRank, KeepsDifferencesOfZeroInItsEstimate) {
  EXPECT_DOUBLE_EQ(signedRank({0, 1, 2, 3}).hodges_lehmann, 1.5);
}

TEST(Holm, IsRsPAdjust) {
  const ReferenceValues r("r_values.txt");
  const auto corrected = holm(r.list("holm.p"));
  for (std::size_t i = 0; i < corrected.size(); ++i) {
    EXPECT_NEAR(corrected[i], r.list("holm.corrected")[i], 1e-12);
  }
}

TEST(Quade, IsRsQuadeTest) {
  const ReferenceValues r("r_values.txt");
  for (int k = 1; k <= 2; ++k) {
    const std::string name = "quade." + std::to_string(k);
    const auto columns = static_cast<std::size_t>(r.number(name + ".columns"));
    std::vector<std::vector<double>> blocks;
    for (const double v : r.list(name + ".values")) {
      if (blocks.empty() || blocks.back().size() == columns) blocks.emplace_back();
      blocks.back().push_back(v);
    }
    const QuadeTest test = quade(blocks);
    EXPECT_NEAR(test.statistic, r.list(name + ".result")[0], 1e-9);
    EXPECT_EQ(test.dof1, r.list(name + ".result")[1]);
    EXPECT_EQ(test.dof2, r.list(name + ".result")[2]);
    EXPECT_NEAR(test.p, r.list(name + ".result")[3], 1e-9);
  }
}

// Three of the same order and range: each has 6 equally likely orders, and two followed the first.
TEST(Quade, CountsOrdersWhereTheRanksAgreeThroughout) {
  const QuadeTest test = quade({{1, 2, 3}, {2, 3, 4}, {10, 11, 12}});
  EXPECT_TRUE(std::isinf(test.statistic));
  EXPECT_NEAR(test.p, 1.0 / 36, 1e-12);
  EXPECT_DOUBLE_EQ(quade({{1, 1, 1}, {2, 2, 2}}).p, 1);
}

TEST(KaplanMeier, IsRsSurvfit) {
  const ReferenceValues r("r_values.txt");
  std::vector<TimeToEvent> times;
  for (std::size_t i = 0; i < r.list("survival.t").size(); ++i) {
    times.push_back({r.list("survival.t")[i], r.list("survival.done")[i] != 0});
  }
  const auto curve = kaplanMeier(times);
  ASSERT_EQ(curve.size(), r.list("survival.times").size());
  for (std::size_t i = 0; i < curve.size(); ++i) {
    EXPECT_DOUBLE_EQ(curve[i].t, r.list("survival.times")[i]);
    EXPECT_EQ(curve[i].at_risk, r.list("survival.at_risk")[i]);
    EXPECT_NEAR(curve[i].survival, r.list("survival.curve")[i], 1e-12);
  }
  EXPECT_NEAR(restrictedMean(curve, 15), r.number("survival.mean.15"), 1e-9);
  EXPECT_NEAR(restrictedMean(curve, 30), r.number("survival.mean.30"), 1e-9);
  EXPECT_EQ(medianSurvival(curve), r.number("survival.median"));
}

TEST(KaplanMeier, HasNoMedianWhereMostGaveUp) {
  const auto curve = kaplanMeier({{10, true}, {60, false}, {60, false}});
  EXPECT_FALSE(medianSurvival(curve));
  EXPECT_NEAR(restrictedMean(curve, 60), (10 + 60 + 60) / 3.0, 1e-12);
  EXPECT_DOUBLE_EQ(restrictedMean({}, 60), 60);
}

// Of an even number, half are done at the middle one, whatever the product of fractions rounds to.
TEST(KaplanMeier, HasItsMedianWhereHalfAreDone) {
  for (int n = 2; n <= 60; n += 2) {
    std::vector<TimeToEvent> times;
    for (int i = 1; i <= n; ++i) times.push_back({static_cast<double>(i), true});
    EXPECT_EQ(medianSurvival(kaplanMeier(times)), n / 2) << n;
  }
}

double meanOf(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x;
  return sum / static_cast<double>(v.size());
}

// Both are drawn, by other random numbers: ends agree to 2 % of the width (R drew 200,000).
TEST(Bca, IsThatOfRWithinGroupsAndThatOfScipy) {
  const ReferenceValues r("r_values.txt"), scipy("scipy_values.txt");
  const auto statistic = [](const Groups& g) { return (meanOf(g[0]) + meanOf(g[1])) / 2; };
  const auto two = bcaInterval({r.list("bca.a"), r.list("bca.b")}, statistic);
  const auto& expected = r.list("bca.interval");
  const double width = expected[1] - expected[0];
  EXPECT_NEAR(two->low, expected[0], 0.02 * width);
  EXPECT_NEAR(two->high, expected[1], 0.02 * width);
  const auto one = bcaInterval({scipy.list("bca.d")}, [](const Groups& g) { return meanOf(g[0]); });
  const auto& others = scipy.list("bca.interval");
  EXPECT_NEAR(one->low, others[0], 0.02 * (others[1] - others[0]));
  EXPECT_NEAR(one->high, others[1], 0.02 * (others[1] - others[0]));
}

// Resampled means that equal the estimate are as much below as above it: of values on either side
// of zero alike, the interval is, too.
TEST(Bca, CountsValuesThatEqualTheEstimateHalf) {
  const auto interval = bcaInterval({{-1, -1, 1, 1}}, [](const Groups& g) { return meanOf(g[0]); });
  EXPECT_DOUBLE_EQ(interval->low, -interval->high);
}

// The skewness of a sum of means is sum_g (sum_i d_i^3 / n_g^3) / (sum_g sum_i d_i^2 / n_g^2)^1.5,
// and the acceleration a sixth of it. Here the small group decides it, whose tail is to the left,
// against the large one, whose is to the right.
TEST(Bca, TheAccelerationOfUnequalGroupsIsTheSkewnessOfTheSum) {
  Groups groups(2);
  for (int i = 0; i < 60; ++i) groups[0].push_back(std::exp(0.05 * i) / 10);
  groups[1] = {-6, -1, -0.5, 0, 0.2, 0.3};
  const auto sum = [](const Groups& g) { return meanOf(g[0]) + meanOf(g[1]); };
  double cubes = 0, squares = 0;
  for (const auto& group : groups) {
    const auto n = static_cast<double>(group.size());
    for (const double x : group) {
      cubes += std::pow((x - meanOf(group)) / n, 3);
      squares += std::pow((x - meanOf(group)) / n, 2);
    }
  }
  const double a = cubes / 6 / std::pow(squares, 1.5);
  std::mt19937_64 random(11);
  std::vector<double> sums;
  for (int k = 0; k < 40'000; ++k) {
    Groups drawn = groups;
    for (std::size_t g = 0; g < 2; ++g) {
      for (double& x : drawn[g]) x = groups[g][random() % groups[g].size()];
    }
    sums.push_back(sum(drawn));
  }
  std::sort(sums.begin(), sums.end());
  const auto shareBelow = [&](double x) {
    const auto below = std::lower_bound(sums.begin(), sums.end(), x) - sums.begin();
    return static_cast<double>(below) / static_cast<double>(sums.size());
  };
  const boost::math::normal_distribution<double> normal;
  const double bias = quantile(normal, shareBelow(sum(groups)));
  const auto interval = bcaInterval(groups, sum);
  // By the shares of the resampled sums below the ends: Phi(z0 + (z0 + z) / (1 - a (z0 + z))).
  for (const double z : {-1.959964, 1.959964}) {
    const double expected = cdf(normal, bias + (bias + z) / (1 - a * (bias + z)));
    const double end = z < 0 ? interval->low : interval->high;
    EXPECT_NEAR(shareBelow(end), expected, 0.005) << z;
  }
}

TEST(Bca, IsEmptyWhereNothingVaries) {
  const auto mean = [](const Groups& g) { return meanOf(g[0]); };
  EXPECT_FALSE(bcaInterval({{1, 1, 1}}, mean));
  EXPECT_FALSE(bcaInterval({{1}}, mean));
}

}  // namespace
}  // namespace plumbline
