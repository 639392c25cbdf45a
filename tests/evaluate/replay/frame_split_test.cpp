// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/frame_split.h"

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/base/frames.h"

namespace plumbline {
namespace {

constexpr TimeNs kStart = 1'400'000'000'123'456'789;
constexpr TimeNs kStep = 50'000'000;  // 20 Hz

/// `count` frames at 20 Hz of two cameras; the second misses every seventh.
Session recording(int count) {
  Session session;
  session.cameras.resize(2);
  for (int i = 0; i < count; ++i) {
    ImageView view{kStart + i * kStep, {}};
    for (int id = 0; id < 8; ++id) view.corners.push_back({id, {10.0 * id, 5.0 * i}});
    session.cameras[0].views.push_back(view);
    if (i % 7 != 3) session.cameras[1].views.push_back(view);
  }
  return session;
}

TEST(FrameSplit, EveryThirdSecondIsHeldOutAndItsNeighboursAreInNeither) {
  const FrameSplit split = splitFrames(recording(130));
  // 20 frames a second: frames 40 to 59 and 100 to 119 are held out; 0.1 s are two frames.
  std::vector<int> held_out, pool;
  for (int f = 0; f < 130; ++f) {
    const bool held = (f >= 40 && f < 60) || (f >= 100 && f < 120);
    const bool near =
        f == 38 || f == 39 || f == 60 || f == 61 || f == 98 || f == 99 || f == 120 || f == 121;
    if (held) held_out.push_back(f);
    if (!held && !near) pool.push_back(f);
  }
  EXPECT_EQ(split.held_out, held_out);
  // A frame exactly 0.1 s from a held-out one's block: 38 + 0.1 s is frame 40 itself.
  EXPECT_EQ(split.pool, pool);
}

TEST(FrameSplit, PositionsAreThoseOfPairFrames) {
  Session session = recording(130);
  // A frame that nobody saw enough of is no frame: all later ones move up.
  session.cameras[0].views[10].corners.resize(3);
  session.cameras[1].views.erase(session.cameras[1].views.begin() + 9);
  const auto frames = pairFrames(session.cameras);
  ASSERT_EQ(frames.size(), 129u);
  const FrameSplit split = splitFrames(session);
  for (const int f : split.held_out) {
    const TimeNs t = frames[static_cast<std::size_t>(f)].t - kStart;
    EXPECT_EQ(t / 1'000'000'000 % 3, 2) << f;
  }
  for (const int f : split.pool) {
    const TimeNs t = frames[static_cast<std::size_t>(f)].t - kStart;
    EXPECT_NE(t / 1'000'000'000 % 3, 2) << f;
  }
  EXPECT_EQ(split.held_out.front(), 39);
}

TEST(FrameSplit, OptionsDecideAndAreChecked) {
  const Session session = recording(130);
  FrameSplitOptions half;
  half.block_s = 0.5;
  half.held_out_every = 2;
  half.guard_s = 0;
  const FrameSplit split = splitFrames(session, half);
  EXPECT_EQ(split.pool.size() + split.held_out.size(), 130u);
  EXPECT_EQ(split.held_out.front(), 10);
  EXPECT_EQ(split.pool[10], 20);
  EXPECT_TRUE(splitFrames(Session()).pool.empty());
  for (const FrameSplitOptions& bad :
       {FrameSplitOptions{0, 3, 0}, FrameSplitOptions{1, 1, 0}, FrameSplitOptions{1, 3, 1}}) {
    EXPECT_THROW(splitFrames(session, bad), InputError);
  }
}

}  // namespace
}  // namespace plumbline
