// SPDX-License-Identifier: BSD-3-Clause
// Twenty simulated recordings: how many views chosen by mutual information are worth 80 random
// ones? For the table of docs/counterfactuals.md thirty.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/base/statistics/statistics.h"
#include "evaluate/replay/counterfactual_curves.h"
#include "evaluate/replay/counterfactuals.h"
#include "tests/evaluate/replay/simulated_pools.h"

namespace plumbline {
namespace {

using test::SimulatedPool;
using test::simulatedPool;
using test::SimulatedPoolOptions;
using test::ViewsTo;
using test::viewsTo;

constexpr int kReference = 80;  // random views
constexpr int kNever = 400;     // the whole pool
// About the bound, four fifths of the reference; every one costs as much as the 60 held-out frames.
const std::vector<int> kViews = {40, 50, 60, 70, 80, 100, 120};
const std::vector<int> kFineViews = {10, 20, 30, 40, 45, 50, 55, 60, 65, 70, 75, 80, 100, 120};

/// PLUMBLINE_FINE_POOLS in the environment: the table of docs/counterfactuals.md.
bool isFine() { return std::getenv("PLUMBLINE_FINE_POOLS") != nullptr; }

int poolCount() { return isFine() ? 30 : 20; }

/// What the pools need, one entry a pool, in numbers of views.
struct Needed {
  std::vector<double> first, for_good;
  void add(const ViewsTo& to) {
    first.push_back(to.first.value_or(kNever));
    for_good.push_back(to.for_good.value_or(kNever));
  }
};

struct Study {
  Needed greedy, coverage, random;
  std::vector<double> target_px;
};

CounterfactualOptions studyOptions() {
  CounterfactualOptions options;
  options.camera.pixel_sigma = SimulatedPoolOptions().sigma_px;
  options.camera.cauchy_px = 0;
  options.random_seeds = isFine() ? 7 : 5;
  options.other_model = false;
  options.online_views = 4;  // as few as may be: that order is not looked at
  options.views = isFine() ? kFineViews : kViews;
  return options;
}

/// Of the seeds' curves: the median, which is what one random order is worth.
CounterfactualCurve medianOf(const CounterfactualBand& band) {
  CounterfactualCurve curve;
  curve.views = band.views;
  for (const auto& px : band.held_out_px) {
    curve.held_out_px.push_back(px ? std::optional(px->median) : std::nullopt);
  }
  return curve;
}

/// The strategies' curves on one pool; empty where it cannot be solved.
std::vector<CounterfactualCurve> curvesOn(const SimulatedPool& simulated) {
  const CounterfactualOptions options = studyOptions();
  const auto pool =
      ViewPool::prepare(simulated.session, simulated.split, options.camera, options.max_held_out);
  if (!pool) return {};
  std::vector<CounterfactualCurve> orders;
  for (CounterfactualCurve& order : strategyOrders(*pool, {}, options)) {
    if (order.strategy == "recorded" || order.strategy == "predicted-error") continue;
    if (order.strategy == "coverage" && !isFine()) continue;
    // Curves are evaluated at their ends, too, which would be the whole pool.
    order.order.resize(std::min<std::size_t>(order.order.size(), kViews.back()));
    orders.push_back(std::move(order));
  }
  return evaluated(*pool, std::move(orders), options.views, options.threads);
}

Study run() {
  Study study;
  for (int p = 0; p < poolCount(); ++p) {
    const SimulatedPool simulated = simulatedPool(p);
    const auto curves = curvesOn(simulated);
    if (curves.empty()) continue;
    const auto bands = bandsOf(curves);
    const CounterfactualCurve random = medianOf(*findBand(bands, "random"));
    const auto at = std::find(random.views.begin(), random.views.end(), kReference);
    const auto target = random.held_out_px[static_cast<std::size_t>(at - random.views.begin())];
    if (!target) continue;
    study.target_px.push_back(*target);
    study.random.add(viewsTo(random, *target));
    study.greedy.add(viewsTo(*curvesOf(curves, "greedy-mi").at(0), *target));
    if (isFine()) study.coverage.add(viewsTo(*curvesOf(curves, "coverage").at(0), *target));
  }
  return study;
}

void report(const char* name, const Needed& needed) {
  std::printf("%-10s first %.0f (quartiles %.0f to %.0f), for good %.0f (%.0f to %.0f)\n", name,
              quantile(needed.first, 0.5), quantile(needed.first, 0.25),
              quantile(needed.first, 0.75), quantile(needed.for_good, 0.5),
              quantile(needed.for_good, 0.25), quantile(needed.for_good, 0.75));
}

TEST(SimulatedPools, GreedyInformationNeedsAFifthFewerViewsThanRandom) {
  const Study study = run();
  ASSERT_EQ(study.target_px.size(), static_cast<std::size_t>(poolCount()));
  report("random", study.random);
  report("greedy-mi", study.greedy);
  if (isFine()) report("coverage", study.coverage);
  // A reference that is reached by luck early would be no reference.
  EXPECT_GE(quantile(study.random.for_good, 0.5), 0.9 * kReference);
  // Held-out corners are exact: what is left is the calibration's error, far below the noise.
  EXPECT_LT(quantile(study.target_px, 1), 0.1);
  EXPECT_GT(quantile(study.target_px, 0), 0.001);
  EXPECT_LE(quantile(study.greedy.first, 0.5), 0.8 * kReference);
  EXPECT_LE(quantile(study.greedy.for_good, 0.5), 0.8 * kReference);
}

}  // namespace
}  // namespace plumbline
