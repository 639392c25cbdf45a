// SPDX-License-Identifier: BSD-3-Clause
// Suggestions by gain per second: the way to a view costs what distance and turn take.
#include "calibrator/guidance/operator_pace.h"

#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"

namespace plumbline {
namespace {

// By hand: a metre along x in fifths, of which the inner four are looked at.
TEST(OperatorPace, LooksAlongTheWayBetweenItsEnds) {
  Transform from, to;
  to.t.x() = 1;
  std::vector<double> looked;
  const auto isBelow = [&](double limit) {
    return [&looked, limit](const Transform& T_FC0) {
      looked.push_back(T_FC0.t.x());
      return T_FC0.t.x() < limit;
    };
  };
  EXPECT_TRUE(seesAlongWay(from, to, isBelow(0.9)));
  ASSERT_EQ(looked.size(), 4u);
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(looked[k], 0.2 * (k + 1), 1e-12);
  EXPECT_FALSE(seesAlongWay(from, to, isBelow(0.7))) << "lost at 0.8";
}

TEST(OperatorPace, TakesTheLongerOfWalkAndTurn) {
  const OperatorPace pace{0.5, 1.0, 0.4};
  const Transform from, walked(Eigen::Matrix3d::Identity(), {0.3, 0.4, 0});
  EXPECT_DOUBLE_EQ(pace.secondsTo(from, walked), 0.4 + 0.5 / 0.5);
  const Transform turned(expSO3({0, 0, 0.2}), {0.3, 0.4, 0});
  EXPECT_DOUBLE_EQ(pace.secondsTo(from, turned), 1.4);  // turns on the way
  const Transform far_turned(expSO3({0, 1.7, 0}), {0.3, 0.4, 0});
  EXPECT_NEAR(pace.secondsTo(from, far_turned), 0.4 + 1.7, 1e-12);
  EXPECT_FALSE(OperatorPace().isKnown());
  EXPECT_THROW((OperatorPace{-1, 1, 0}.check()), InputError);
}

TEST(OperatorPace, OrdersByGainPerSecond) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  using Order = std::vector<std::size_t>;
  EXPECT_EQ(byGainPerSecond({1, 3, kNan, 2}, {1, 6, 1, 1}), (Order{3, 0, 1}));
  EXPECT_EQ(byGainPerSecond({kInf, 3, kInf}, {5, 1, 2}), (Order{2, 0, 1}));
  EXPECT_EQ(byGainPerSecond({1, 2, 3 * (1 + 1e-13)}, {1, 2, 3}), (Order{0, 1, 2})) << "rounding";
}

TEST(BestCandidate, IsTheFirstOfThoseThatDifferByRounding) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(bestCandidate({1, 2.8, 2.8 + 4e-13}), 1);
  EXPECT_EQ(bestCandidate({1, 2.8, 2.8 * (1 + 1e-5)}), 2);
  EXPECT_EQ(bestCandidate({-0.3, -0.1 * (1 + 1e-12), -0.1}), 1) << "errors: the lowest";
  EXPECT_EQ(bestCandidate({kNan, 2, kInf, kInf}), 2);
  EXPECT_EQ(bestCandidate({kNan, kNan}), -1);
  EXPECT_EQ(bestCandidate({-kInf}), -1);
  EXPECT_EQ(bestCandidate({}), -1);
}

}  // namespace
}  // namespace plumbline
