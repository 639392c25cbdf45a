// SPDX-License-Identifier: BSD-3-Clause
// Views chosen while they come, on simulated pools of which the truth is known.
#include "evaluate/replay/online_order.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/information/view_selection.h"
#include "tests/evaluate/replay/simulated_pools.h"

namespace plumbline {
namespace {

constexpr double kSigma = 0.3;

test::SimulatedPool simulated(int index) {
  test::SimulatedPoolOptions options;
  options.frames = 120;
  options.duration_s = 60;
  options.held_out_frames = 40;
  options.sigma_px = kSigma;
  options.held_out_sigma = kSigma;
  return test::simulatedPool(index, options);
}

ViewPool prepared(const test::SimulatedPool& simulated) {
  CameraStageOptions camera;
  camera.cauchy_px = 0;
  camera.pixel_sigma = kSigma;
  return ViewPool::prepare(simulated.session, simulated.split, camera, 40).value();
}

std::vector<int> startOf(const ViewPool& pool, std::uint64_t seed) {
  std::vector<int> first;
  for (const int i : randomOrder(static_cast<int>(pool.pool().size()), seed)) {
    if (first.size() < 3) first.push_back(pool.pool()[static_cast<std::size_t>(i)]);
  }
  return first;
}

double errorAt(const ViewPool& pool, const std::vector<int>& order, std::size_t views) {
  const std::vector<int> used(order.begin(), order.begin() + static_cast<int>(views));
  return pool.heldOutError(pool.solve(used).value().estimate).px;
}

TEST(OnlineOrder, BeginsWithTheStartAndTakesEveryFrameOnce) {
  const auto recording = simulated(0);
  const ViewPool pool = prepared(recording);
  OnlineOrderOptions options;
  options.most_views = 12;
  for (const auto criterion : {ViewCriterion::kPredictedError, ViewCriterion::kMutualInformation}) {
    options.criterion = criterion;
    const std::vector<int> first = startOf(pool, 1);
    const OnlineOrder found = onlineOrder(pool, pool.pool(), first, options);
    ASSERT_EQ(found.order.size(), 12u);
    EXPECT_TRUE(std::equal(first.begin(), first.end(), found.order.begin()));
    EXPECT_EQ(std::set<int>(found.order.begin(), found.order.end()).size(), 12u);
    ASSERT_FALSE(found.steps.empty());
    EXPECT_EQ(found.steps.front().views, 3);
    EXPECT_EQ(onlineOrder(pool, pool.pool(), first, options).order, found.order);
  }
}

/// An estimate from three views of which nothing is known is too far off for a criterion of first
/// order about it.
TEST(OnlineOrder, UpToFourViewsEitherCriterionGoesByInformation) {
  int apart = 0;
  for (int p = 0; p < 3; ++p) {
    const auto recording = simulated(p);
    const ViewPool pool = prepared(recording);
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const auto ordered = [&](ViewCriterion criterion) {
        OnlineOrderOptions options;
        options.criterion = criterion;
        options.most_views = 8;
        return onlineOrder(pool, pool.pool(), startOf(pool, seed), options).order;
      };
      const std::vector<int> error = ordered(ViewCriterion::kPredictedError);
      const std::vector<int> information = ordered(ViewCriterion::kMutualInformation);
      ASSERT_GE(error.size(), std::size_t{kLeastViewsForError});
      EXPECT_TRUE(
          std::equal(error.begin(), error.begin() + kLeastViewsForError, information.begin()))
          << "rig " << p << ", start " << seed;
      apart += error == information ? 0 : 1;
    }
  }
  EXPECT_GT(apart, 0) << "from there on they are two criteria";
}

/// The model is right: no misfit is found, the prediction is the variance, and what is measured on
/// held-out frames of the same motion is what was predicted, on average over rigs and starts.
TEST(OnlineOrder, PredictedAndMeasuredExcessAgreeWhereTheModelFits) {
  std::vector<double> ratio;
  for (int p = 0; p < 3; ++p) {
    const auto recording = simulated(p);
    const ViewPool pool = prepared(recording);
    const double whole = pool.heldOutError(pool.reference().estimate).px;
    OnlineOrderOptions options;
    options.most_views = 10;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const OnlineOrder found = onlineOrder(pool, pool.pool(), startOf(pool, seed), options);
      const auto at_8 = std::find_if(found.steps.begin(), found.steps.end(),
                                     [](const OnlineStep& s) { return s.views == 8; });
      ASSERT_NE(at_8, found.steps.end());
      EXPECT_NEAR(std::sqrt(at_8->components.sigma2) / kSigma, 1, 0.1);
      const double px = errorAt(pool, found.order, 8);
      ratio.push_back((px * px - whole * whole) / at_8->predicted_px2);
      EXPECT_LT(px, 1.03 * whole) << "rig " << p << ", start " << seed;
    }
  }
  // A sum of 8 to 22 squares each, over another motion than the pool's, whose own error (8 of 120
  // views' worth) is in the reference: a factor of two either way.
  EXPECT_GT(quantile(ratio, 0.5), 0.4);
  EXPECT_LT(quantile(ratio, 0.5), 2.0);
}

TEST(OnlineOrder, FewChosenViewsAreWorthMoreThanAsManyRandomOnes) {
  double chosen = 0, random = 0;
  for (int p = 0; p < 3; ++p) {
    const auto recording = simulated(p);
    const ViewPool pool = prepared(recording);
    const double whole = pool.heldOutError(pool.reference().estimate).px;
    OnlineOrderOptions options;
    options.most_views = 6;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const OnlineOrder found = onlineOrder(pool, pool.pool(), startOf(pool, seed), options);
      chosen += errorAt(pool, found.order, 6) / whole - 1;
      std::vector<int> order;
      for (const int i : randomOrder(static_cast<int>(pool.pool().size()), seed)) {
        order.push_back(pool.pool()[static_cast<std::size_t>(i)]);
      }
      random += errorAt(pool, order, 6) / whole - 1;
    }
  }
  EXPECT_LT(chosen, 0.5 * random);
}

TEST(OnlineOrder, ABadPhotographIsNotTaken) {
  auto recording = simulated(0);
  const int bad = recording.split.pool[40];
  const TimeNs t = pairFrames(recording.session.cameras)[static_cast<std::size_t>(bad)].t;
  for (CameraStream& camera : recording.session.cameras) {
    for (ImageView& view : camera.views) {
      if (std::abs(view.t - t) > 1'000'000) continue;
      for (std::size_t i = 0; i < view.corners.size(); ++i) {
        view.corners[i].uv += Eigen::Vector2d(i % 2 == 0 ? 5 : -5, i % 3 == 0 ? 5 : -2);
      }
    }
  }
  const ViewPool pool = prepared(recording);
  OnlineOrderOptions options;
  options.most_views = 60;
  const OnlineOrder found = onlineOrder(pool, pool.pool(), startOf(pool, 2), options);
  EXPECT_EQ(std::count(found.order.begin(), found.order.end(), bad), 0);
}

}  // namespace
}  // namespace plumbline
