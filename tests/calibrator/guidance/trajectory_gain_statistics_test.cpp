// SPDX-License-Identifier: BSD-3-Clause
// Do predicted gains come true? In situations that differ in motion, length and noise, each
// trajectory is scored at the window's estimate, then recorded with noise by the true rig, and the
// recording and the trajectory are solved together: 0.5 log of the covariances' ratio.
#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "calibrator/information/covariance.h"
#include "tests/calibrator/guidance/recorded_trajectory.h"

namespace plumbline {
namespace {

struct Pair {
  double predicted, real;
};

SimulationOptions situation(int k) {
  SimulationOptions options;
  options.duration_s = 1.5 + 0.75 * k;
  options.corner_sigma_px = k % 2 == 0 ? 0.2 : 0.5;
  options.seed = options.trajectory.seed = static_cast<std::uint64_t>(10 + k);
  options.trajectory.pace = 0.7 + 0.1 * (k % 4);
  options.down_F = k % 3 == 0 ? Eigen::Vector3d(0.1, -0.5, -1) : Eigen::Vector3d(0.1, -1, 0.2);
  return options;
}

std::vector<Pair> pairsOf(int k) {
  const SimulationOptions options = situation(k);
  const test::WindowRecording r = test::recordingOf(options, options.corner_sigma_px);
  const auto window = test::windowOver(r, 25);
  if (!window) return {};
  const WindowKnowledge now = *window->knowledge();
  test::RecordedTrajectoryOptions how;
  how.corner_sigma_px = options.corner_sigma_px;
  how.imu_noise = true;
  const auto six = lissajousTrajectories(lissajousShapes(), AprilGrid{}, now.estimate.T_SC0, {});
  const TrajectoryScorer scorer(test::plannedRecording(r, how), six, r.truth.cameras);
  const auto gains = scorer.scores(now).gain_nats;
  const auto alone = test::solvedWithOffsetHeld(r.problem, r.truth);
  const auto before = test::batchInformation(r.problem, alone);
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < six.size(); ++i) {
    how.seed = 100 * static_cast<std::uint64_t>(k) + i;
    const auto joint = test::jointProblem(r, test::recordAlong(six[i], r, now.t, how));
    const auto solved = test::solvedWithOffsetHeld(joint.problem, joint.truth);
    const auto after = test::batchInformation(joint.problem, solved);
    pairs.push_back({gains[i], *mutualInformationNats(before, after)});
  }
  return pairs;
}

std::vector<double> ranks(std::vector<Pair> pairs, double Pair::*value) {
  std::vector<std::size_t> order(pairs.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return pairs[a].*value < pairs[b].*value; });
  std::vector<double> out(pairs.size());
  for (std::size_t k = 0; k < order.size(); ++k) out[order[k]] = static_cast<double>(k);
  return out;
}

double rankCorrelation(const std::vector<Pair>& pairs) {
  const auto a = ranks(pairs, &Pair::predicted);
  const auto b = ranks(pairs, &Pair::real);
  double squares = 0;
  for (std::size_t k = 0; k < a.size(); ++k) squares += (a[k] - b[k]) * (a[k] - b[k]);
  const auto n = static_cast<double>(a.size());
  return 1 - 6 * squares / (n * (n * n - 1));
}

TEST(TrajectoryGainStatistics, PredictedGainsComeTrue) {
  std::vector<Pair> pairs;
  int best_is_among_best = 0;
  constexpr int kSituations = 12;
  for (int k = 0; k < kSituations; ++k) {
    const auto some = pairsOf(k);
    ASSERT_EQ(some.size(), 6u) << k;
    const auto best = std::max_element(some.begin(), some.end(), [](const Pair& a, const Pair& b) {
      return a.predicted < b.predicted;
    });
    const auto most = std::max_element(
        some.begin(), some.end(), [](const Pair& a, const Pair& b) { return a.real < b.real; });
    if (best->real > 0.95 * most->real) ++best_is_among_best;
    pairs.insert(pairs.end(), some.begin(), some.end());
  }
  double product = 0, square = 0, least = 1e9, largest = 0;
  for (const Pair& p : pairs) {
    product += p.predicted * p.real;
    square += p.predicted * p.predicted;
    EXPECT_GT(p.predicted, 0.7 * p.real);
    EXPECT_LT(p.predicted, 1.4 * p.real);
    least = std::min(least, p.real);
    largest = std::max(largest, p.real);
  }
  RecordProperty("slope", std::to_string(product / square));
  RecordProperty("rank_correlation", std::to_string(rankCorrelation(pairs)));
  RecordProperty("least", std::to_string(least));
  RecordProperty("largest", std::to_string(largest));
  EXPECT_GT(largest, 3 * least);  // the situations differ enough for a correlation to say something
  EXPECT_GT(product / square, 0.8);
  EXPECT_LT(product / square, 1.2);
  EXPECT_GT(rankCorrelation(pairs), 0.9);
  EXPECT_EQ(best_is_among_best, kSituations);
}

}  // namespace
}  // namespace plumbline
