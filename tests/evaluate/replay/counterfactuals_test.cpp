// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/counterfactuals.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/simulate/simulate_session.h"
#include "evaluate/replay/counterfactual_curves.h"
#include "tests/evaluate/replay/simulated_pools.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// 60 s at 5 Hz: 200 frames less guards in the pool, 100 held out.
Session recording() {
  SimulationOptions simulation;
  simulation.duration_s = 60;
  simulation.camera_rate_hz = 5;
  simulation.imu_rate_hz = 10;
  return simulateSession(simulatedRig("euroc"), simulation).session;
}

CounterfactualOptions quick() {
  CounterfactualOptions options;
  options.camera.pixel_sigma = 0.2;
  options.random_seeds = 3;
  options.views = {5, 10, 20, 40, 80};
  options.max_held_out = 40;
  options.other_model = false;
  options.threads = 2;
  return options;
}

const CounterfactualCurve& curveOf(const Counterfactuals& found, const std::string& strategy) {
  return *curvesOf(found.curves, strategy).at(0);
}

TEST(Counterfactuals, EveryStrategyUsesThePoolAndEndsWithAllOfIt) {
  const Session session = recording();
  const FrameSplit split = splitFrames(session);
  // Every third frame, half of them twice, as a guide would never do.
  std::vector<int> guide;
  for (int f = 0; f < 300; f += 3) guide.push_back(f);
  guide.insert(guide.end(), guide.begin(), guide.begin() + 50);
  const Counterfactuals found = counterfactuals(session, guide, quick());
  EXPECT_EQ(found.problem, "");
  EXPECT_EQ(found.pool_frames, static_cast<int>(split.pool.size()));
  EXPECT_EQ(found.held_out_frames, 40);
  std::vector<std::string> names;
  for (const auto& band : found.bands) names.push_back(band.strategy);
  EXPECT_THAT(names, ElementsAre("recorded", "random", "greedy-mi", "predicted-error", "coverage",
                                 "guide"));
  ASSERT_EQ(found.curves.size(), 8u);
  for (const CounterfactualCurve& curve : found.curves) {
    std::vector<int> used = curve.order;
    std::sort(used.begin(), used.end());
    if (curve.strategy == "predicted-error") {
      EXPECT_EQ(curve.order.size(), 40u);
    }
    if (curve.strategy == "guide" || curve.strategy == "predicted-error") continue;
    EXPECT_EQ(used, split.pool) << curve.strategy;
    EXPECT_EQ(curve.views.back(), found.pool_frames);
    EXPECT_EQ(curve.entropy_nats.back().value(), found.full_pool_entropy_nats);
    EXPECT_EQ(curve.held_out_px.back().value(), found.full_pool_held_out_px);
    ASSERT_TRUE(curve.views_needed) << curve.strategy;
  }
  std::vector<int> kept;
  for (int f = 0; f < 300; f += 3) {
    if (std::binary_search(split.pool.begin(), split.pool.end(), f)) kept.push_back(f);
  }
  const CounterfactualCurve& own = curveOf(found, "guide");
  EXPECT_EQ(own.order, kept);
  EXPECT_EQ(own.views.back(), static_cast<int>(kept.size()));
  EXPECT_EQ(curveOf(found, "recorded").order, split.pool);
  EXPECT_EQ(curveOf(found, "random").seed, 1u);
  EXPECT_THAT(found.remarks.back(),
              HasSubstr("Of 150 frames that the guide kept " + std::to_string(kept.size())));
}

TEST(Counterfactuals, GreedyInformationIsSurestAtEveryNumberOfViews) {
  const Counterfactuals found = counterfactuals(recording(), {}, quick());
  const CounterfactualCurve& greedy = curveOf(found, "greedy-mi");
  for (std::size_t i = 0; i + 1 < greedy.views.size(); ++i) {
    for (const CounterfactualCurve& other : found.curves) {
      if (&other == &greedy || !other.entropy_nats[i]) continue;
      // Greedy is no optimum: covering comes close to it, and the least predicted error, which with
      // a model that fits is the least variance in the image, may be surer.
      const double margin = other.strategy == "coverage"          ? -0.2
                            : other.strategy == "predicted-error" ? -1.0
                                                                  : 1.0;
      EXPECT_LT(*greedy.entropy_nats[i], *other.entropy_nats[i] - margin)
          << other.strategy << " with " << greedy.views[i];
    }
  }
  // The model holds here: what is known better predicts better.
  EXPECT_LT(greedy.held_out_px[1].value(), findBand(found.bands, "random")->held_out_px[1]->median);
}

TEST(Counterfactuals, ViewsNeededAreTheFewestThatStayWithinTenPercent) {
  // Exact corners held out: their error is the calibration's own.
  const test::SimulatedPool pool = test::simulatedPool(0, {120, 60, 20});
  const Counterfactuals found = counterfactuals(pool.session, {}, quick(), pool.split);
  const double target = 1.1 * found.full_pool_held_out_px;
  for (const char* strategy : {"recorded", "random"}) {
    const int needed = curveOf(found, strategy).views_needed.value();
    ASSERT_GT(needed, 5) << "a recording too easy to tell";
    CounterfactualOptions closer = quick();
    closer.views = {needed - 1, needed};
    const Counterfactuals again = counterfactuals(pool.session, {}, closer, pool.split);
    const CounterfactualCurve& there = curveOf(again, strategy);
    const auto at = [&](int views) {
      const auto place = std::find(there.views.begin(), there.views.end(), views);
      return there.held_out_px[static_cast<std::size_t>(place - there.views.begin())];
    };
    EXPECT_GT(at(needed - 1).value_or(1e9), target) << strategy;
    EXPECT_LE(at(needed).value(), target) << strategy;
  }
}

TEST(Counterfactuals, NothingDependsOnTheThreads) {
  const Session session = recording();
  CounterfactualOptions options = quick();
  options.views = {8, 30};
  options.other_model = true;
  options.threads = 1;
  const Counterfactuals one = counterfactuals(session, {1, 30, 60}, options);
  options.threads = 3;
  const Counterfactuals three = counterfactuals(session, {1, 30, 60}, options);
  ASSERT_EQ(one.curves.size(), three.curves.size());
  for (std::size_t c = 0; c < one.curves.size(); ++c) {
    EXPECT_EQ(one.curves[c].order, three.curves[c].order);
    EXPECT_EQ(one.curves[c].entropy_nats, three.curves[c].entropy_nats);
    EXPECT_EQ(one.curves[c].held_out_px, three.curves[c].held_out_px);
    EXPECT_EQ(one.curves[c].views_needed, three.curves[c].views_needed);
  }
  EXPECT_EQ(one.remarks, three.remarks);
  EXPECT_EQ(one.other_model, "pinhole-equidistant");
}

TEST(Counterfactuals, AMisfittingModelIsNamedByTheOther) {
  // A fisheye calibrated as radtan.
  SimulationOptions simulation;
  simulation.duration_s = 30;
  simulation.camera_rate_hz = 5;
  simulation.imu_rate_hz = 10;
  const Session session = simulateSession(simulatedRig("tumvi"), simulation).session;
  CounterfactualOptions options = quick();
  options.other_model = true;
  options.camera.models = {2, {ProjectionModel::kPinhole, DistortionModel::kRadtan}};
  options.camera.cauchy_px = 0;
  const Counterfactuals found = counterfactuals(session, {}, options);
  ASSERT_EQ(found.problem, "");
  EXPECT_EQ(found.other_model, "pinhole-equidistant");
  const CounterfactualBand* other = findBand(found.other_model_bands, "random");
  ASSERT_NE(other, nullptr);
  // The truth leaves the noise; the other leaves more than twice as much.
  EXPECT_NEAR(other->held_out_px.back()->median, 0.2 * std::sqrt(2.0), 0.02);
  EXPECT_GT(found.full_pool_held_out_px, 0.6);
  EXPECT_THAT(found.remarks, ::testing::Contains(HasSubstr("With pinhole-equidistant the error")));
  // Figures of another number of views are not stated for this one.
  Counterfactuals apart = found;
  for (CounterfactualBand& band : apart.other_model_bands) {
    for (int& views : band.views) ++views;
  }
  const auto pool =
      ViewPool::prepare(session, splitFrames(session), options.camera, options.max_held_out);
  ASSERT_TRUE(pool);
  EXPECT_THAT(counterfactualRemarks(pool.value(), apart, 0),
              Not(::testing::Contains(HasSubstr("With pinhole-equidistant the error"))));
  // Nothing is said of others where there are none.
  CounterfactualCurve& guide = apart.curves.emplace_back();
  guide.strategy = "guide";
  guide.order = {pool->pool()[0], pool->pool()[1]};
  EXPECT_THAT(counterfactualRemarks(pool.value(), apart, 3).back(), HasSubstr("the other lies"));
  EXPECT_THAT(counterfactualRemarks(pool.value(), apart, 2).back(),
              HasSubstr("All 2 frames that the guide kept"));
}

TEST(Counterfactuals, OneCameraWillDo) {
  Session session = recording();
  session.cameras.pop_back();
  const Counterfactuals found = counterfactuals(session, {}, quick());
  EXPECT_EQ(found.problem, "");
  EXPECT_EQ(found.bands.size(), 5u);
  // Corners with 0.2 px of noise per axis, and little that the calibration adds.
  EXPECT_NEAR(found.full_pool_held_out_px, 0.2 * std::sqrt(2.0), 0.02);
}

TEST(Counterfactuals, SaysWhyThereAreNone) {
  Session session = recording();
  for (CameraStream& camera : session.cameras) {
    for (ImageView& view : camera.views) view.corners.clear();
  }
  const Counterfactuals found = counterfactuals(session, {}, quick());
  EXPECT_THAT(found.curves, IsEmpty());
  EXPECT_THAT(found.problem, HasSubstr("cam0"));
  CounterfactualOptions bad = quick();
  bad.random_seeds = 0;
  EXPECT_THROW(counterfactuals(session, {}, bad), InputError);
  bad = quick();
  bad.views = {0};
  EXPECT_THROW(counterfactuals(session, {}, bad), InputError);
}

}  // namespace
}  // namespace plumbline
