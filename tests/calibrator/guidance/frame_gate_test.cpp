// SPDX-License-Identifier: BSD-3-Clause
// One gate for both stages: stamps, pauses, work and a target out of view.
#include "calibrator/guidance/frame_gate.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/guidance/start_check.h"
#include "tests/calibrator/guidance/camera_guide_replay.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

class FrameGateTest : public ::testing::Test {
 protected:
  bool arrives(double t_s) {
    d = Decision();
    d.t = toNanoseconds(t_s);
    GuideFrame frame;
    frame.t = d.t;
    return gate.arrives(frame, open, d);
  }
  bool shows(double t_s, bool target) { return arrives(t_s) && gate.hasTarget(target, d); }

  FrameGate gate{GuideOptions()};
  std::optional<OpenSuggestion> open;
  Decision d;
};

TEST_F(FrameGateTest, HoldsBackStampsThatAreNotAfterAllBefore) {
  EXPECT_TRUE(arrives(10));
  EXPECT_TRUE(d.detail.empty());
  EXPECT_FALSE(arrives(9.5));
  EXPECT_EQ(d.reason, GuideReason::kTimeJump);
  EXPECT_THAT(d.detail, HasSubstr("0.500000 s before"));
  EXPECT_FALSE(arrives(9.9)) << "still before the last that arrived";
  EXPECT_FALSE(arrives(10));
  EXPECT_THAT(d.detail, HasSubstr("is not after that of the frame before"));
  EXPECT_TRUE(arrives(10.1));
}

TEST_F(FrameGateTest, OneStampFarAheadDoesNotHoldBackTheFramesAfterIt) {
  EXPECT_TRUE(arrives(10));
  EXPECT_FALSE(arrives(1000));
  EXPECT_EQ(d.reason, GuideReason::kTimeJump);
  EXPECT_THAT(d.detail, HasSubstr("990.000000 s after"));
  EXPECT_TRUE(arrives(10.1));
  EXPECT_TRUE(d.detail.empty()) << d.detail;
  EXPECT_FALSE(arrives(1000));
  EXPECT_FALSE(arrives(2000)) << "as far from the frame before as that";
  EXPECT_FALSE(arrives(10.1));
  EXPECT_TRUE(arrives(10.2));
  EXPECT_FALSE(gate.isAfterPause());
}

TEST_F(FrameGateTest, OnlyTheFrameJustBeforeConfirmsAStampFarAhead) {
  EXPECT_TRUE(arrives(10));
  EXPECT_FALSE(arrives(1000));
  EXPECT_FALSE(arrives(9.9));
  EXPECT_FALSE(arrives(1001)) << "the one before was in its time";
  EXPECT_TRUE(arrives(10.2));
  EXPECT_FALSE(gate.isAfterPause());
}

TEST_F(FrameGateTest, TwoFramesInOrderReplaceAFirstOneFarAfterThem) {
  EXPECT_FALSE(shows(1000, false));
  gate.work(d.t, 0.2);
  EXPECT_FALSE(arrives(10));
  EXPECT_FALSE(gate.replacesFirst());
  EXPECT_TRUE(arrives(10.1)) << d.detail;
  EXPECT_TRUE(gate.replacesFirst());
  EXPECT_FALSE(gate.isAfterPause());
  EXPECT_FALSE(gate.hasTarget(false, d));
  EXPECT_EQ(d.detail, "time begins anew: the only frame before is 989.900 s after it")
      << "the target has not been out of view for 10 s";
  EXPECT_TRUE(arrives(10.2));
  EXPECT_FALSE(gate.replacesFirst());
  EXPECT_FALSE(arrives(1000.1)) << "the first one confirms nothing";
  EXPECT_TRUE(arrives(10.3));
}

TEST_F(FrameGateTest, TwoFramesInOrderReplaceAFirstOneFarBeforeThem) {
  EXPECT_TRUE(shows(0, true));
  EXPECT_EQ(gate.since(), 0);
  EXPECT_FALSE(arrives(1000));
  EXPECT_TRUE(arrives(1000.1)) << d.detail;
  EXPECT_TRUE(gate.replacesFirst());
  EXPECT_EQ(gate.since(), toNanoseconds(1000.1));
  EXPECT_FALSE(gate.isAfterPause());
  EXPECT_EQ(d.detail, "time begins anew: the only frame before is 1000.100 s before it");
  EXPECT_TRUE(arrives(1000.2));
  EXPECT_FALSE(gate.replacesFirst());
  EXPECT_EQ(gate.since(), toNanoseconds(1000.1));
}

// It cannot be told from a wrong stamp.
TEST_F(FrameGateTest, APauseAfterTheFirstFrameIsSaidThoughItIsReplaced) {
  EXPECT_TRUE(arrives(0));
  EXPECT_FALSE(arrives(60));
  EXPECT_TRUE(arrives(60.1));
  EXPECT_TRUE(gate.replacesFirst());
  EXPECT_EQ(d.detail, "time begins anew: the only frame before is 60.100 s before it");
  EXPECT_TRUE(arrives(60.2));
  EXPECT_TRUE(d.detail.empty()) << d.detail;
}

TEST_F(FrameGateTest, OneFrameDoesNotReplaceTheFirstAndTwoNotAnyLater) {
  EXPECT_TRUE(arrives(1000));
  EXPECT_FALSE(arrives(10));
  EXPECT_TRUE(arrives(1000.1));
  EXPECT_FALSE(arrives(10.1));
  EXPECT_FALSE(arrives(10.2));
  EXPECT_TRUE(arrives(1000.2));
}

TEST_F(FrameGateTest, KnowsTheFrameOfTheStageBefore) {
  gate = FrameGate(GuideOptions(), 0, toNanoseconds(10));
  EXPECT_FALSE(arrives(1000));
  EXPECT_TRUE(arrives(10.1));
  EXPECT_FALSE(arrives(9.9));
  EXPECT_FALSE(arrives(9.95));
}

TEST_F(FrameGateTest, ASlowCameraIsNotDoubtedForAShortGap) {
  GuideOptions options;
  options.max_frame_gap_s = 0.05;
  gate = FrameGate(options);
  EXPECT_TRUE(arrives(10));
  EXPECT_TRUE(arrives(11));
  EXPECT_TRUE(gate.isAfterPause());
  EXPECT_TRUE(arrives(14));
  EXPECT_FALSE(arrives(20));
}

TEST_F(FrameGateTest, ALongPauseIsOneOnceASecondFrameConfirmsIt) {
  EXPECT_TRUE(arrives(9.9));
  EXPECT_TRUE(arrives(10));
  EXPECT_FALSE(arrives(60));
  EXPECT_TRUE(arrives(60.1));
  EXPECT_TRUE(gate.isAfterPause());
  EXPECT_THAT(d.detail, HasSubstr("no frame for 50.100 s"));
  EXPECT_TRUE(arrives(60.2));
  EXPECT_FALSE(arrives(10.1));
}

TEST_F(FrameGateTest, HoldsBackWhatComesDuringWork) {
  EXPECT_TRUE(arrives(10));
  gate.work(d.t, 0.2);
  gate.workOn(0.3);
  EXPECT_EQ(gate.busyUntil(), toNanoseconds(10.5));
  EXPECT_FALSE(arrives(10.45));
  EXPECT_EQ(d.reason, GuideReason::kBusy);
  EXPECT_TRUE(arrives(10.5));
}

// Nobody saw where the camera was during the pause, so that a suggestion is not reached across it.
TEST_F(FrameGateTest, SaysAPauseAndForgetsThatTheSuggestionWasNear) {
  const std::vector<Corner> corners{{0, {0, 0}}, {1, {9, 0}}, {2, {0, 9}}, {3, {9, 9}}};
  Suggestion s;
  s.t = toNanoseconds(9.9);
  open.emplace(s, corners, ReachRule{15, 0.5, 100});
  EXPECT_TRUE(arrives(10));
  EXPECT_EQ(open->update(d.t, corners).held_s, 0);
  EXPECT_TRUE(arrives(10.2));
  EXPECT_NEAR(open->update(d.t, corners).held_s, 0.2, 1e-9);
  EXPECT_TRUE(arrives(12.2));
  EXPECT_TRUE(gate.isAfterPause());
  EXPECT_THAT(d.detail, HasSubstr("no frame for 2.000 s"));
  EXPECT_EQ(open->update(d.t, corners).event, SuggestionEvent::kNone);
  EXPECT_TRUE(arrives(12.3));
  EXPECT_FALSE(gate.isAfterPause());
}

TEST_F(FrameGateTest, SaysOnceThatTheTargetIsLongOutOfViewAndThatItIsBack) {
  EXPECT_TRUE(shows(10, true));
  int said = 0;
  for (int k = 1; k <= 30; ++k) {
    EXPECT_FALSE(shows(10 + 0.1 * k, false));
    EXPECT_EQ(d.reason, GuideReason::kNoTarget);
    said += d.detail.empty() ? 0 : 1;
    if (!d.detail.empty()) {
      EXPECT_THAT(d.detail, HasSubstr("out of view for 2.100 s"));
    }
  }
  EXPECT_EQ(said, 1);
  EXPECT_TRUE(shows(13.1, true));
  EXPECT_THAT(d.detail, HasSubstr("back after 3.100 s"));
  EXPECT_FALSE(shows(13.2, false));
  EXPECT_TRUE(shows(13.3, true));
  EXPECT_TRUE(d.detail.empty()) << "a short loss is not worth a word";
}

// Where the target was meanwhile nobody saw.
TEST_F(FrameGateTest, SaysNothingOfTheTargetDuringWork) {
  EXPECT_TRUE(shows(10, true));
  gate.work(d.t, 5);
  for (int k = 1; k < 50; ++k) EXPECT_FALSE(arrives(10 + 0.1 * k));
  EXPECT_FALSE(shows(15, false));
  EXPECT_EQ(d.reason, GuideReason::kNoTarget);
  EXPECT_TRUE(d.detail.empty()) << d.detail;
  EXPECT_TRUE(shows(15.1, true));
  EXPECT_TRUE(d.detail.empty()) << d.detail;
}

// A tag in the place of another costs any cameras the same.
TEST(StartCheck, TwoTagsThatExchangedTheirIdsDoNotSpeakAgainstTheCameras) {
  const test::LiveRig rig("euroc", 1, test::kGuideSigma);
  StartCheck check(rig.guideRig(), test::guideOptions());
  bool due = false;
  for (int i = 0; !due && i < 40; ++i) {
    GuideFrame frame = rig.frame(i, 0.5 * i, rig.wandering(0.5 * i));
    if (i == 3) {
      std::vector<Corner>& corners = frame.corners[0];
      for (Corner& corner : corners) {
        const int tag = corner.id / 4;
        if (tag == 14 || tag == 15) corner.id += tag == 14 ? 4 : -4;
      }
      std::ranges::sort(corners, {}, &Corner::id);
    }
    due = check.isDue(frame, usableViews(frame, rig.truth().size(), 16));
  }
  ASSERT_TRUE(due);
  EXPECT_EQ(check.against(rig.truth()), std::nullopt);
}

}  // namespace
}  // namespace plumbline
