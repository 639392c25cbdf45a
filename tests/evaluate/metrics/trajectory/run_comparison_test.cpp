// SPDX-License-Identifier: BSD-3-Clause
// Paired differences: which pairs count, the exact sign test, an interval that covers.

#include "evaluate/metrics/trajectory/run_comparison.h"

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/report/synthetic_studies.h"

namespace plumbline {
namespace {

TrajectoryRun run(const std::string& sequence, const std::string& calibration, double rmse,
                  const std::string& repetition = "") {
  TrajectoryRun r;
  r.run = repetition;
  r.sequence = sequence;
  r.calibration = calibration;
  r.ate_translation_m.rmse = rmse;
  r.ate_translation_m.n = 10;
  return r;
}

TEST(SignTest, IsTheBinomialTail) {
  EXPECT_DOUBLE_EQ(signTest(0, 0), 1);
  EXPECT_NEAR(signTest(8, 8), 2.0 / 256, 1e-12);
  EXPECT_NEAR(signTest(0, 8), 2.0 / 256, 1e-12);
  EXPECT_NEAR(signTest(1, 8), 2.0 * 9 / 256, 1e-12);
  EXPECT_NEAR(signTest(4, 8), 1, 1e-12);
}

TEST(PairedDifferences, AreOfTheSameSequenceWhateverTheOrder) {
  const auto d = pairedDifferences(
      {run("x", "a", 1), run("y", "a", 5), run("y", "b", 5.5), run("x", "b", 1.25)});
  ASSERT_EQ(d.size(), 1U);
  EXPECT_EQ(d[0].a, "a");
  EXPECT_EQ(d[0].b, "b");
  EXPECT_EQ(d[0].pairs, 2U);
  EXPECT_DOUBLE_EQ(d[0].mean_m, 0.375);
  EXPECT_EQ(d[0].b_better, 0U);
  EXPECT_FALSE(d[0].low_m.has_value()) << "two pairs make no interval";
}

// The better one is that of the smaller error, whichever was named first.
TEST(PairedDifferences, TheBetterOneHasTheSmallerErrors) {
  for (const double sign : {1.0, -1.0}) {
    std::vector<TrajectoryRun> runs;
    for (int i = 0; i < 6; ++i) {
      runs.push_back(run(std::to_string(i), "a", 2));
      runs.push_back(run(std::to_string(i), "b", 2 + sign * (1 + 0.01 * i)));
    }
    const PairedDifference d = pairedDifferences(runs)[0];
    EXPECT_EQ(d.better, sign < 0 ? "b" : "a");
    EXPECT_EQ(d.b_better, sign < 0 ? 6U : 0U);
  }
}

// Pairs have a spread and a median of their own, besides that of the sequences' means: -1, 3 and 7.
TEST(PairedDifferences, MedianAndSpreadAreOfPairs) {
  const auto d =
      pairedDifferences({run("x", "a", 9, "1"), run("x", "b", 8, "1"), run("x", "a", 9, "2"),
                         run("x", "b", 12, "2"), run("y", "a", 9), run("y", "b", 16)})[0];
  EXPECT_DOUBLE_EQ(d.median_m, 3);
  EXPECT_DOUBLE_EQ(d.mean_m, (1 + 7) / 2.0);
  EXPECT_DOUBLE_EQ(d.std_m, std::sqrt((16 + 0 + 16) / 3.0));
}

// A run that failed stands behind every error; one without a ground truth is in no order.
TEST(RunsSummary, TheMedianIsOverTheRunsThatHaveATruth) {
  const auto summaryOf = [](std::vector<TrajectoryRun> runs) { return summarised(runs).at(0); };
  const TrajectoryRun good = run("x", "a", 1), better = run("x", "a", 0.5);
  TrajectoryRun failed = good, partial = good, without = good;
  failed.status = RunStatus::kFailed;
  partial.status = RunStatus::kPartial;
  without.without_truth = true;
  without.ate_translation_m = {};
  EXPECT_EQ(summaryOf({good, better, better}).ate_median_m, 0.5);
  EXPECT_EQ(summaryOf({good, better, failed}).ate_median_m, 1);
  EXPECT_FALSE(summaryOf({good, failed}).ate_median_m);
  EXPECT_EQ(summaryOf({good, without, without}).ate_median_m, 1);
  EXPECT_EQ(summaryOf({good, partial}).level, VerdictLevel::kCaution);
  EXPECT_EQ(summaryOf({good, partial, failed}).level, VerdictLevel::kBad);
  EXPECT_EQ(summaryOf({good, without}).level, VerdictLevel::kGood);
}

TEST(PairedDifferences, ARunWithoutATruthHasNoErrorToCompare) {
  TrajectoryRun without = run("x", "b", 0);
  without.without_truth = true;
  without.ate_translation_m = {};
  const auto d = pairedDifferences({run("x", "a", 1), without});
  EXPECT_EQ(d[0].pairs, 0U);
  EXPECT_EQ(d[0].left_out, 1U);
}

TEST(PairedDifferences, CountWhatTheyLeaveOut) {
  const auto d = pairedDifferences(test::syntheticTrajectories().runs);
  ASSERT_EQ(d.size(), 1U);
  // Of six pairs one has a failed run, and one a partial run.
  EXPECT_EQ(d[0].pairs, 4U);
  EXPECT_EQ(d[0].left_out, 2U);
  EXPECT_GT(d[0].mean_m, 0);
}

TEST(PairedDifferences, TiesDoNotVote) {
  const auto d =
      pairedDifferences({run("x", "a", 1), run("x", "b", 1), run("y", "a", 2), run("y", "b", 1)});
  EXPECT_EQ(d[0].ties, 1U);
  EXPECT_EQ(d[0].b_better, 1U);
  EXPECT_DOUBLE_EQ(d[0].sign_test_p, 1);
}

// (t_{0.975, 9} + t_{0.8, 9}) / sqrt(10) = (2.26216 + 0.88340) / 3.16228 = 0.9947, 1.0650 for nine.
TEST(PairedDifferences, SequencesNeededAreThoseOfStudentsT) {
  const auto needed = [](const std::vector<double>& differences) {
    std::vector<TrajectoryRun> runs;
    for (std::size_t i = 0; i < differences.size(); ++i) {
      runs.push_back(run(std::to_string(i), "a", 4));
      runs.push_back(run(std::to_string(i), "b", 4 + differences[i]));
    }
    return pairedDifferences(runs)[0].pairs_needed;
  };
  EXPECT_EQ(needed({0, 1, 2}), 10);    // a spread as large as the mean
  EXPECT_EQ(needed({0, -1, -2}), 10);  // the sign is of no matter
  EXPECT_EQ(needed({-1, 1, 3}), 34);   // twice as large
  EXPECT_EQ(needed({1, 2, 3}), 5);     // half: fewer would do, and give no interval
  EXPECT_EQ(needed({1, 1, 1}), 5);
  EXPECT_FALSE(needed({1, 0, -1}).has_value());
  EXPECT_GT(needed({1, 0, -1.000001}).value(), 1e6);
}

// With as many sequences as it asks for, the interval leaves out 0 in about four of five studies:
// 73 for a spread of three times the mean.
TEST(PairedDifferences, PairsNeededShowTheDifferenceFourTimesInFive) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0.1, 0.3);
  const auto studyOfPairs = [&](int pairs) {
    std::vector<TrajectoryRun> runs;
    for (int i = 0; i < pairs; ++i) {
      runs.push_back(run(std::to_string(i), "a", 1));
      runs.push_back(run(std::to_string(i), "b", 1 + noise(random)));
    }
    return pairedDifferences(runs)[0];
  };
  EXPECT_FALSE(studyOfPairs(2).pairs_needed.has_value()) << "no spread to tell from";
  const double needed = studyOfPairs(4000).pairs_needed.value();
  EXPECT_NEAR(needed, 73, 15);  // the mean of 4000 is known to 5 %
  int shown = 0;
  for (int study = 0; study < 200; ++study) {
    shown += studyOfPairs(73).better.empty() ? 0 : 1;
  }
  EXPECT_NEAR(shown, 160, 20);  // binomial: 5.7
}

// 400 studies of five sequences with three runs each, which are alike: a true mean of 0.1, a
// standard deviation of 0.3 over sequences and of 0.05 over their runs.
TEST(PairedDifferences, IntervalCoversTheTruthAsOftenAsItSays) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.1, 0.3);
  int covered = 0;
  for (int study = 0; study < 400; ++study) {
    std::vector<TrajectoryRun> runs;
    for (int i = 0; i < 5; ++i) {
      const double of_sequence = 1 + noise(random);
      for (const char* repetition : {"1", "2", "3"}) {
        runs.push_back(run(std::to_string(i), "a", 1, repetition));
        const double own = 0.05 * (noise(random) - 0.1) / 0.3;
        runs.push_back(run(std::to_string(i), "b", of_sequence + own, repetition));
      }
    }
    const auto d = pairedDifferences(runs);
    ASSERT_TRUE(d[0].low_m && d[0].high_m);
    if (*d[0].low_m <= 0.1 && 0.1 <= *d[0].high_m) ++covered;
  }
  EXPECT_NEAR(covered, 380, 13);  // binomial: 4.4
}

// Of five sequences that differ, four are better under b: in the fifth most runs are, and the mean
// is not.
TEST(PairedDifferences, TheSignTestIsOfSequences) {
  std::vector<TrajectoryRun> runs;
  const auto add = [&runs](const std::string& sequence, const std::vector<double>& differences) {
    for (std::size_t i = 0; i < differences.size(); ++i) {
      runs.push_back(run(sequence, "a", 4, std::to_string(i)));
      runs.push_back(run(sequence, "b", 4 + differences[i], std::to_string(i)));
    }
  };
  for (const char* sequence : {"s", "t", "u", "v"}) add(sequence, {-1, -1, -2});
  add("w", {-1, -1, 4});
  add("x", {-1, 1});
  const PairedDifference d = pairedDifferences(runs)[0];
  EXPECT_EQ(d.pairs, 17U);
  EXPECT_EQ(d.b_better, 15U);
  EXPECT_EQ(d.ties, 0U);
  EXPECT_NEAR(d.sign_test_p, 2 * 6 / 32.0, 1e-12) << "a mean of 0 has no sign";
}

TEST(PairedDifferences, RunsOfOneSequenceMakeNoInterval) {
  std::vector<TrajectoryRun> runs;
  for (int i = 0; i < 10; ++i) {
    runs.push_back(run("x", "a", 1, std::to_string(i)));
    runs.push_back(run("x", "b", 2 + 0.01 * i, std::to_string(i)));
  }
  runs.push_back(run("y", "a", 1));
  runs.push_back(run("y", "b", 1));
  const PairedDifference d = pairedDifferences(runs)[0];
  EXPECT_EQ(d.pairs, 11U);
  EXPECT_NEAR(d.mean_m, 0.5 * 1.045, 1e-12) << "sequences count alike, whatever their runs";
  EXPECT_FALSE(d.low_m);
  EXPECT_EQ(d.better, "");
  EXPECT_DOUBLE_EQ(d.sign_test_p, 1);
}

}  // namespace
}  // namespace plumbline
