// SPDX-License-Identifier: BSD-3-Clause
// The draws of the bootstrap and their summary, without a calibration behind. Not proven here: that
// their spread is that of a calibration (camera_imu_resample_test).
#include "calibrator/batch/resample.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"

namespace plumbline {
namespace {

ResampleOptions drawOptions(int draws, int segments) {
  ResampleOptions options;
  options.draws = draws;
  options.segments = segments;
  return options;
}

/// Firsts and weights.
std::set<std::pair<int, double>> outline(const std::vector<FrameSegment>& segments) {
  std::set<std::pair<int, double>> out;
  for (const FrameSegment& s : segments) out.insert({s.first, s.weight});
  return out;
}

// 23 frames in 5 segments: cut at 0, 4, 9, 13, 18 and 23.
TEST(DrawSegments, AreAsManyAsThereAreWithWhatIsDrawnTwiceCountingTwice) {
  const std::vector<int> cuts{0, 4, 9, 13, 18, 23};
  bool missed = false, repeated = false;
  for (int draw = 0; draw < 20; ++draw) {
    double drawn = 0;
    int before = -1;
    for (const FrameSegment& s : drawSegments(23, drawOptions(20, 5), draw)) {
      EXPECT_GT(s.first, before);
      before = s.first;
      const auto cut = std::find(cuts.begin(), cuts.end(), s.first);
      ASSERT_NE(cut, cuts.end());
      EXPECT_EQ(s.first + s.count, *(cut + 1));
      drawn += s.weight;
      repeated |= s.weight > 1;
    }
    EXPECT_EQ(drawn, 5);
    missed |= drawSegments(23, drawOptions(20, 5), draw).size() < 5;
  }
  EXPECT_TRUE(missed && repeated);
}

TEST(DrawSegments, AreOthersInEveryDrawAndUnderEverySeedAndTheSameAgain) {
  ResampleOptions options = drawOptions(20, 20);
  const auto first = outline(drawSegments(1000, options, 0));
  EXPECT_EQ(outline(drawSegments(1000, options, 0)), first);
  EXPECT_NE(outline(drawSegments(1000, options, 1)), first);
  options.seed += std::uint64_t{1} << 32;  // all 64 bits of it count
  EXPECT_NE(outline(drawSegments(1000, options, 0)), first);
}

TEST(DrawSegments, AreNoMoreThanFrames) {
  double frames = 0;
  for (const FrameSegment& s : drawSegments(3, drawOptions(2, 20), 0)) {
    EXPECT_EQ(s.count, 1);
    frames += s.weight;
  }
  EXPECT_EQ(frames, 3);
  EXPECT_TRUE(drawSegments(0, drawOptions(2, 20), 0).empty());
}

ParameterCovariance named() {
  ParameterCovariance parameters;
  parameters.names = {"a", "b"};
  parameters.units = {"m", "rad"};
  return parameters;
}

// Of 1, 2, 6: mean 3, (4 + 1 + 9) / 2 = 7. About the draws' own mean, not about the solution.
TEST(SummariseDraws, TheSpreadIsThatOfASample) {
  Eigen::MatrixXd draws(2, 3);
  draws << 1, 2, 6, 5, 5, 5;
  const ResampleSummary summary = summariseDraws(named(), draws, 4);
  EXPECT_DOUBLE_EQ(summary.std(0), std::sqrt(7));
  EXPECT_EQ(summary.std(1), 0);
  EXPECT_EQ(summary.failed, 4);
  EXPECT_EQ(summary.units[1], "rad");
  EXPECT_EQ(summariseDraws(named(), draws.leftCols(1), 0).std, Eigen::Vector2d::Zero());
}

/// Solves draw k as (k, number of its frames), but for those that fail.
DrawSolver solverOf(int& next, const std::set<int>& failing) {
  return [&next, failing](const std::vector<FrameSegment>& segments) {
    double frames = 0;
    for (const FrameSegment& s : segments) frames += s.weight * s.count;
    const int draw = next++;
    if (failing.count(draw) > 0) return std::optional<Eigen::VectorXd>();
    return std::optional<Eigen::VectorXd>(Eigen::Vector2d(draw, frames));
  };
}

TEST(SolveDraws, LeavesOutThoseWithoutASolutionAndCountsThem) {
  int next = 0;
  const auto summary =
      solveDraws(named(), 100, drawOptions(6, 10), "camera", solverOf(next, {0, 3, 4}));
  ASSERT_TRUE(summary.ok());
  EXPECT_EQ(next, 6);
  EXPECT_EQ(summary->failed, 3);
  Eigen::MatrixXd expected(2, 3);
  expected << 1, 2, 5, 100, 100, 100;  // ten frames a segment, ten of them
  EXPECT_EQ(summary->draws, expected);
}

TEST(SolveDraws, OneSolutionHasNoSpread) {
  int next = 0;
  const auto summary =
      solveDraws(named(), 100, drawOptions(3, 10), "camera", solverOf(next, {0, 2}));
  ASSERT_FALSE(summary.ok());
  EXPECT_EQ(summary.failure().code, FailureCode::kTooFewDraws);
  EXPECT_EQ(summary.failure().number("failed"), 2);
}

}  // namespace
}  // namespace plumbline
