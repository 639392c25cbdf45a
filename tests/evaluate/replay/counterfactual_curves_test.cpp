// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/counterfactual_curves.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace plumbline {
namespace {

using ::testing::ElementsAre;

CounterfactualCurve curve(const char* strategy, std::vector<std::optional<double>> px) {
  CounterfactualCurve c;
  c.strategy = strategy;
  c.views = {5, 10, 20};
  c.views.resize(px.size());
  c.entropy_nats = px;
  c.held_out_px = std::move(px);
  return c;
}

TEST(CounterfactualBands, QuartilesOverSeedsAndRegretAgainstTheBestMedian) {
  const std::vector<CounterfactualCurve> curves = {
      curve("random", {std::nullopt, 4.0, 2.0}), curve("random", {9.0, 8.0, 3.0}),
      curve("random", {7.0, 6.0, 2.5}), curve("greedy-mi", {6.0, 5.0})};
  const auto bands = bandsOf(curves);
  ASSERT_EQ(bands.size(), 2u);
  EXPECT_EQ(bands[0].seeds, 3);
  EXPECT_FALSE(bands[0].held_out_px[0]);  // one seed has no value
  EXPECT_EQ(bands[0].held_out_px[1]->lower, 5.0);
  EXPECT_EQ(bands[0].held_out_px[1]->median, 6.0);
  EXPECT_EQ(bands[0].held_out_px[1]->upper, 7.0);
  EXPECT_FALSE(bands[0].regret_px[0]);
  EXPECT_EQ(bands[0].regret_px[1], 1.0);
  EXPECT_EQ(bands[0].regret_px[2], 0.0);
  EXPECT_EQ(bands[1].regret_px[0], 0.0);
  const auto with = withRegret(curves, bands);
  EXPECT_FALSE(with[0].regret_px[0]);
  EXPECT_EQ(with[0].regret_px[1], -1.0);  // a lucky seed
  EXPECT_EQ(with[1].regret_px[0], 3.0);
  EXPECT_EQ(with[1].regret_px[2], 0.5);
  EXPECT_EQ(findBand(bands, "guide"), nullptr);
}

TEST(CounterfactualBands, DefaultNumbersOfViewsEndWithEveryOrder) {
  CounterfactualCurve whole, guide;
  whole.order.resize(300);
  guide.order.resize(37);
  EXPECT_THAT(evaluatedViews({whole, guide}, {}),
              ElementsAre(5, 8, 10, 15, 20, 30, 37, 40, 60, 80, 120, 160, 240, 300));
  EXPECT_THAT(evaluatedViews({whole, guide}, {10, 400}), ElementsAre(10, 37, 300));
}

}  // namespace
}  // namespace plumbline
