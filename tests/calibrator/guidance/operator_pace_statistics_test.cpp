// SPDX-License-Identifier: BSD-3-Clause
// A guide that knows an operator's pace, over whole recordings: nearer views are asked for first,
// and on no way is the target lost.
#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/guidance/guide_options.h"
#include "tests/calibrator/guidance/camera_guide_replay.h"

namespace plumbline {
namespace {

using test::LiveRig;

/// Time and distance to what was suggested, by the pose when it was.
struct Asked {
  int count = 0;
  double way_m = 0;
};

/// What a guide told that pace decided; tests share what takes seconds.
const std::vector<Decision>& playedAtPace(double speed_m_s, unsigned seed = 3) {
  static std::map<std::pair<double, unsigned>, std::vector<Decision>> played;
  const auto [at, is_new] = played.try_emplace({speed_m_s, seed});
  if (is_new) {
    const LiveRig rig("euroc", seed, 0.2);
    GuideOptions options;
    options.pace.speed_m_s = speed_m_s;
    CameraGuide guide(rig.guideRig(), options);
    at->second = test::playGuided(guide, rig, 400);
  }
  return at->second;
}

TEST(CameraGuide, AsksForNearerViewsOfASlowOperator) {
  // Which views are asked for hangs on rounding, so that one person's few say little.
  Asked any, slow;
  for (const unsigned seed : {3U, 4U, 5U}) {
    for (Asked* sum : {&any, &slow}) {
      for (const Decision& d : playedAtPace(sum == &slow ? 0.05 : 0, seed)) {
        if (!d.opened || !d.round) continue;  // not the first, which is asked for without
        ++sum->count;
        sum->way_m += (d.opened->T_FC0.t - d.T_FC0->t).norm();
      }
    }
  }
  ASSERT_GT(any.count, 5);
  ASSERT_GT(slow.count, 5);
  EXPECT_LT(slow.way_m / slow.count, 0.8 * any.way_m / any.count);
}

TEST(CameraGuide, SaysHowLongAViewWillTake) {
  const OperatorPace pace{0.35};
  for (const Decision& d : playedAtPace(0.35)) {
    if (d.round) EXPECT_EQ(d.round->reach_s.empty(), d.event != SuggestionEvent::kOpened);
    if (!d.opened || !d.round) continue;  // not the first, which is asked for without
    ASSERT_TRUE(d.opened->reach_s);
    const double hold_s = ViewGuideOptions().reached_s;
    EXPECT_DOUBLE_EQ(*d.opened->reach_s, pace.secondsTo(*d.T_FC0, d.opened->T_FC0) + hold_s);
    // Nothing that is worth asking for gains more per second, unless its way loses the target.
    EXPECT_GE(d.opened->mi_nats, d.threshold_nats);
  }
  for (const Decision& d : playedAtPace(0)) {
    // The way does not count; how long it takes is said all the same.
    if (d.opened) EXPECT_GT(d.opened->reach_s.value_or(0), ViewGuideOptions().reached_s);
    if (d.round) EXPECT_TRUE(d.round->reach_s.empty());
  }
}

// Whoever wants so many views is asked for the best, worth it or not; no way is to blame.
TEST(CameraGuide, AsksForTheBestWhereNoViewIsWorthIt) {
  const LiveRig rig("euroc", 5, 0.3);
  GuideOptions options;
  options.views.threshold_nats = 1;
  options.views.min_views = 100;
  options.pace.speed_m_s = 0.35;
  CameraGuide guide(rig.guideRig(), options);
  int below = 0;
  for (const Decision& d : test::playGuided(guide, rig, 400)) {
    if (!d.opened || !d.round || d.round->mi_nats[static_cast<std::size_t>(d.round->best)] >= 1)
      continue;
    EXPECT_EQ(d.opened->candidate, d.round->names[static_cast<std::size_t>(d.round->best)]);
    EXPECT_EQ(d.detail, "");
    ++below;
  }
  EXPECT_GT(below, 0);
}

/// The fewest corners along the way to what was asked for, in the camera that sees most.
std::size_t fewestOnTheWay(const LiveRig& rig, const Decision& d) {
  const Vector6d way = boxminus(d.opened->T_FC0, *d.T_FC0);
  std::size_t fewest = 1000;
  for (int k = 1; k < 10; ++k) {
    const GuideFrame there = rig.frame(0, 0, boxplus(*d.T_FC0, Vector6d(way * k / 10)));
    std::size_t most = 0;
    for (const auto& corners : there.corners) most = std::max(most, corners.size());
    fewest = std::min(fewest, most);
  }
  return fewest;
}

// Views count from as many corners on as hardly any way keeps: where the way to the best view does
// not, another is asked for, and where none does, none, and the log says so.
TEST(CameraGuide, AsksForAnotherWhereTheTargetIsLostOnTheWayToTheBest) {
  for (const double pace : {0.0, 0.35}) {
    GuideOptions options;
    options.views.min_corners = 130;
    options.pace.speed_m_s = pace;
    const LiveRig rig("euroc", 3, 0.2);
    CameraGuide guide(rig.guideRig(), options);
    int others = 0, none = 0;
    for (const Decision& d : test::playGuided(guide, rig, 600)) {
      if (!d.round) continue;  // the first is asked for without
      if (d.detail.find("out of view on the path to every") != std::string::npos) {
        ++none;
        EXPECT_FALSE(d.opened);
        EXPECT_FALSE(d.suggestion);
        continue;
      }
      if (!d.opened) continue;
      const auto best = static_cast<std::size_t>(d.round->best);
      if (d.opened->candidate != d.round->names[best]) ++others;
      // By the true cameras, and at more places than the guide looks at.
      EXPECT_GE(fewestOnTheWay(rig, d), 100u) << d.opened->candidate;
    }
    EXPECT_GT(others, 0) << pace;
    EXPECT_GT(none, 0) << pace;
  }
}

// Whether the pace is known or not.
TEST(CameraGuide, AsksForNoViewOnWhoseWayTheTargetIsLost) {
  const LiveRig rig("euroc", 3, 0.2);
  int checked = 0;
  for (const double pace : {0.35, 0.0}) {
    for (const Decision& d : playedAtPace(pace)) {
      if (!d.opened || !d.round) continue;  // not the first, which is asked for without
      EXPECT_GE(fewestOnTheWay(rig, d), 16u) << d.opened->candidate;
      ++checked;
    }
  }
  EXPECT_GT(checked, 5);
}

}  // namespace
}  // namespace plumbline
