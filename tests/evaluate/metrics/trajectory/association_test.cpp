// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/trajectory/association.h"

#include <algorithm>
#include <random>
#include <set>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr TimeNs kMs = 1'000'000;

// Poses at these stamps; x is the stamp [ms], y the index.
Trajectory at(const std::vector<TimeNs>& stamps_ms) {
  Trajectory trajectory;
  for (const TimeNs t : stamps_ms) {
    const Eigen::Vector3d p(static_cast<double>(t), static_cast<double>(trajectory.poses.size()),
                            0);
    trajectory.poses.push_back({t * kMs, p, Eigen::Quaterniond::Identity()});
  }
  return trajectory;
}

// Sorted ticks that repeat now and then, so that ties and duplicates are met.
Ticks randomTicks(std::mt19937& random, int count, int span) {
  Ticks ticks;
  std::uniform_int_distribution<int> tick(0, span);
  for (int i = 0; i < count; ++i) ticks.push_back(tick(random));
  std::sort(ticks.begin(), ticks.end());
  return ticks;
}

// What closestFirst promises, by enumerating every pair.
std::vector<StampMatch> closestFirstByEnumeration(const Ticks& a, const Ticks& b, double max_dt) {
  std::vector<std::tuple<std::int64_t, std::size_t, std::size_t>> all;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::int64_t dt = std::abs(a[i] - b[j]);
      if (static_cast<double>(dt) <= max_dt) all.emplace_back(dt, i, j);
    }
  }
  std::sort(all.begin(), all.end());
  std::set<std::size_t> used_a, used_b;
  std::vector<StampMatch> matches;
  for (const auto& [dt, i, j] : all) {
    if (used_a.contains(i) || used_b.contains(j)) continue;
    used_a.insert(i);
    used_b.insert(j);
    matches.push_back({i, j});
  }
  std::sort(matches.begin(), matches.end(),
            [](const auto& x, const auto& y) { return x.estimate < y.estimate; });
  return matches;
}

TEST(ClosestFirst, EqualsTheEnumerationOfAllPairs) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 500; ++trial) {
    const Ticks a = randomTicks(random, 1 + trial % 20, 30 + trial % 50);
    const Ticks b = randomTicks(random, 1 + trial % 33, 30 + trial % 50);
    const double max_dt = trial % 9;
    EXPECT_EQ(closestFirst(a, b, max_dt), closestFirstByEnumeration(a, b, max_dt)) << trial;
  }
}

TEST(ClosestFirst, AFarPoseDoesNotTakeTheCloserOnesPartner) {
  // 10 would take 12 in a sweep; 12 itself is the closest pair and goes first.
  EXPECT_THAT(closestFirst({10, 12}, {12}, 5), ElementsAre(StampMatch{1, 0}));
  EXPECT_THAT(forwardSweep({10, 12}, {12}, 5), ElementsAre(StampMatch{0, 0}));
}

TEST(NearestOfShorter, MayUseAPoseTwice) {
  EXPECT_THAT(nearestOfShorter({10, 11}, {10, 20, 30}, 5),
              ElementsAre(StampMatch{0, 0}, StampMatch{1, 0}));
  EXPECT_THAT(closestFirst({10, 11}, {10, 20, 30}, 5), ElementsAre(StampMatch{0, 0}));
}

TEST(NearestOfShorter, TakesTheEarlierOfTwoEquallyNear) {
  EXPECT_THAT(nearestOfShorter({15}, {10, 10, 20}, 5), ElementsAre(StampMatch{0, 0}));
  // The truth is the shorter one: its poses look for partners.
  EXPECT_THAT(nearestOfShorter({10, 20, 21}, {20}, 5), ElementsAre(StampMatch{1, 0}));
}

TEST(ForwardSweep, TheBoundIsNotIncludedAndTheCursorMovesOn) {
  EXPECT_THAT(forwardSweep({10}, {15}, 5), IsEmpty());
  EXPECT_THAT(forwardSweep({10, 11}, {9, 10, 12}, 5),
              ElementsAre(StampMatch{0, 1}, StampMatch{1, 2}));
}

TEST(Associate, OneToOneIsInjectiveAndInOrder) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 50; ++trial) {
    const Association found =
        associate(at(randomTicks(random, 200, 3000)), at(randomTicks(random, 300, 3000)), {});
    ASSERT_GT(found.pairs.size(), 100U);
    std::set<double> truth;
    double last = -1;
    for (const PosePair& pair : found.pairs) {
      EXPECT_GT(pair.estimate.p.y(), last);  // in order, so none twice
      EXPECT_TRUE(truth.insert(pair.truth.p.y()).second);
      last = pair.estimate.p.y();
    }
  }
}

TEST(Associate, MaximumIsIncludedByDefaultAndExcludedByRpg) {
  AssociationOptions options;
  options.max_dt_s = 0.015625;  // exact in binary
  Trajectory truth = at({0});
  truth.poses[0].t = 15'625'000;
  EXPECT_EQ(associate(at({0}), truth, options).pairs.size(), 1U);
  options.rule = AssociationRule::kRpg;
  EXPECT_EQ(associate(at({0}), truth, options).pairs.size(), 0U);
}

// Whatever the units in which a rule compares, its limit is one of seconds.
TEST(Associate, EveryRuleHasItsMaximumInSeconds) {
  for (const AssociationRule rule : {AssociationRule::kOneToOne, AssociationRule::kEvo,
                                     AssociationRule::kRpg, AssociationRule::kOvEval}) {
    AssociationOptions options;
    options.rule = rule;
    options.max_dt_s = 0.02;
    EXPECT_EQ(associate(at({1000}), at({1019}), options).pairs.size(), 1U) << toString(rule);
    EXPECT_EQ(associate(at({1000}), at({1021}), options).pairs.size(), 0U) << toString(rule);
    EXPECT_EQ(associate(at({1000}), at({1019}), options).record.max_dt_s, 0.02);
  }
}

// What belongs to a pose of the estimate, such as its covariance, is found by its index.
TEST(Associate, KeepsTheIndicesOfTheEstimate) {
  AssociationOptions options;
  options.max_dt_s = 0.002;
  options.max_gap_s = 1;
  const Trajectory estimate = at({0, 100, 200, 300, 400}), truth = at({50, 99, 201, 250, 399});
  EXPECT_THAT(associate(estimate, truth, options).estimate_index, ElementsAre(1, 2, 4));
  options.rule = AssociationRule::kInterpolate;
  const Association found = associate(estimate, truth, options);
  EXPECT_THAT(found.estimate_index, ElementsAre(1, 2, 3));
  EXPECT_EQ(found.record.max_dt_s, 0) << "interpolated poses have their own stamps";
}

TEST(Associate, CountsDuplicatesAndGapsAndTheClockOffset) {
  const AssociationRecord record =
      associate(at({0, 10, 10, 20, 50, 50, 50}), at({3, 13, 23, 53, 153}), {}).record;
  EXPECT_EQ(record.rule, "one-to-one");
  EXPECT_EQ(record.estimate_poses, 7U);
  EXPECT_EQ(record.truth_poses, 5U);
  EXPECT_EQ(record.matches, 4U);
  EXPECT_EQ(record.estimate_duplicates, 3U);
  EXPECT_EQ(record.truth_duplicates, 0U);
  EXPECT_DOUBLE_EQ(record.median_dt_s, -0.003);
  EXPECT_DOUBLE_EQ(record.largest_estimate_gap_s, 0.03);
  EXPECT_DOUBLE_EQ(record.largest_truth_gap_s, 0.1);
}

TEST(Associate, AddsTheOffsetToTheEstimate) {
  AssociationOptions options;
  options.time_offset_s = 100;
  const Association found = associate(at({0, 10}), at({100'001, 100'011}), options);
  ASSERT_EQ(found.pairs.size(), 2U);
  EXPECT_EQ(found.pairs[0].estimate.t, 100'000 * kMs);
  EXPECT_DOUBLE_EQ(found.record.median_dt_s, -0.001);
}

TEST(Associate, InterpolatesWithinGapsOnly) {
  AssociationOptions options;
  options.rule = AssociationRule::kInterpolate;
  options.max_gap_s = 0.02;
  // Before the truth; half-way; on a pose; in a gap of 80 ms; after the truth.
  const Association found = associate(at({5, 15, 20, 50, 120}), at({10, 20, 100}), options);
  ASSERT_EQ(found.pairs.size(), 2U);
  EXPECT_EQ(found.pairs[0].truth.t, 15 * kMs);
  EXPECT_DOUBLE_EQ(found.pairs[0].truth.p.x(), 15);
  EXPECT_DOUBLE_EQ(found.pairs[1].truth.p.x(), 20);
  EXPECT_EQ(found.record.stamps_in_gaps, 1U);
}

TEST(PoseAt, TurnsUniformlyOnTheShorterArc) {
  const Eigen::AngleAxisd turn(1.2, Eigen::Vector3d(1, 2, -1).normalized());
  Eigen::Quaterniond q(turn);
  q.coeffs() *= -1.001;  // the other sign, and not quite unit
  const std::vector<StampedPose> poses{{0, {0, 0, 0}, Eigen::Quaterniond::Identity()},
                                       {100, {8, 0, 4}, q}};
  const StampedPose pose = poseAt(poses, 25, 100).pose.value();
  EXPECT_TRUE(pose.p.isApprox(Eigen::Vector3d(2, 0, 1)));
  const Eigen::Quaterniond expected(Eigen::AngleAxisd(0.3, turn.axis()));
  EXPECT_NEAR(pose.q.angularDistance(expected), 0, 1e-12);
  EXPECT_TRUE(poseAt(poses, 25, 100).pose.has_value()) << "a gap of the limit is within it";
  EXPECT_FALSE(poseAt(poses, 25, 99).pose.has_value());
  EXPECT_TRUE(poseAt(poses, 25, 99).in_gap);
}

}  // namespace
}  // namespace plumbline
