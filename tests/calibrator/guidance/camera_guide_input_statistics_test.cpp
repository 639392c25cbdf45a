// SPDX-License-Identifier: BSD-3-Clause
// Frames that the camera stage cannot use, and the time that it takes.
#include <algorithm>
#include <cmath>
#include <iterator>

#include <gtest/gtest.h>

#include "calibrator/guidance/guide.h"
#include "tests/calibrator/guidance/camera_guide_replay.h"

namespace plumbline {
namespace {

using test::LiveRig;

TEST(CameraGuide, RecordingTooShortToStartSaysSo) {
  const LiveRig rig("euroc", 1, 0.3);
  CameraGuide guide(rig.guideRig(), {});
  const auto decisions = test::playWandering(guide, rig, 2, 10);
  for (const Decision& d : decisions) {
    EXPECT_EQ(d.mode, GuideMode::kInitialising);
    EXPECT_EQ(d.reason, GuideReason::kInitialising);
    EXPECT_TRUE(d.accepted);
    EXPECT_FALSE(d.entropy_nats.has_value());
  }
  EXPECT_FALSE(guide.finished());
  const auto batch = guide.batch();
  ASSERT_FALSE(batch.ok());
  EXPECT_EQ(batch.failure().reason(), FailureReason::kTooFewViews);
  EXPECT_FALSE(CameraGuide(rig.guideRig(), {}).batch().ok());
}

TEST(CameraGuide, StartsWhenTheFramesSuffice) {
  const LiveRig rig("euroc", 1, 0.3);
  CameraGuide guide(rig.guideRig(), {});
  // Head-on views that only slide tell no focal length: the start is tried and put off.
  const auto slide = [&](int i) {
    const Eigen::Matrix3d R = Eigen::Vector3d(1, -1, -1).asDiagonal();
    return Transform(R, Eigen::Vector3d(0.2 + 0.04 * i, 0.33, 0.9));
  };
  int failed = 0;
  for (int i = 0; i < 8; ++i) {
    const Decision d = guide.step(rig.frame(i, 0.1 * i, slide(i)));
    EXPECT_EQ(d.mode, GuideMode::kInitialising);
    EXPECT_TRUE(d.accepted);
    if (d.reason != GuideReason::kInitialiseFailed) continue;
    ++failed;
    EXPECT_EQ(i, 4);
    EXPECT_NE(d.detail.find("initialisation failed with 5 frames"), std::string::npos) << d.detail;
    EXPECT_NE(d.detail.find("trying again with 10"), std::string::npos) << d.detail;
    EXPECT_TRUE(d.failure.has_value());
  }
  EXPECT_EQ(failed, 1);
  for (int i = 8; i < 30; ++i) {
    const Decision d = guide.step(rig.frame(i, 0.1 * i, rig.wandering(0.3 * i)));
    if (d.reason != GuideReason::kInitialised) continue;
    EXPECT_EQ(i % 5, 4);
    EXPECT_TRUE(d.entropy_nats.has_value());
    EXPECT_TRUE(d.rmse_px.has_value());
    return;
  }
  FAIL() << "never started";
}

TEST(CameraGuide, FramesWithoutMotionDoNotStartIt) {
  const LiveRig rig("euroc", 1, 0.3);
  CameraGuide guide(rig.guideRig(), {});
  for (int i = 0; i < 10; ++i) {
    const Decision d = guide.step(rig.frame(i, 0.1 * i, rig.wandering(0)));
    EXPECT_EQ(d.reason, GuideReason::kInitialising);
    EXPECT_EQ(d.accepted, i == 0);
    EXPECT_EQ(d.views_kept, 1);
  }
}

TEST(CameraGuide, LostTargetIsSaidOnceAndItsReturn) {
  const LiveRig rig("euroc", 2, 0.3);
  CameraGuide guide(rig.guideRig(), {});
  const auto decisions = test::playWandering(guide, rig, 120, 10, [](GuideFrame& frame) {
    if (frame.index < 60 || frame.index >= 95) return;
    for (auto& corners : frame.corners) corners.resize(std::min<std::size_t>(corners.size(), 15));
  });
  for (std::size_t i = 60; i < 95; ++i) {
    EXPECT_EQ(decisions[i].reason, GuideReason::kNoTarget);
    EXPECT_EQ(decisions[i].entropy_nats, decisions[59].entropy_nats);
    EXPECT_EQ(decisions[i].detail.empty(), i != 80) << i << decisions[i].detail;
  }
  EXPECT_NE(decisions[80].detail.find("out of view for 2.100 s"), std::string::npos);
  EXPECT_NE(decisions[95].detail.find("back after 3.600 s"), std::string::npos)
      << decisions[95].detail;
  EXPECT_NE(decisions[95].reason, GuideReason::kNoTarget);
}

TEST(CameraGuide, CornersThatGiveNoPoseAreLeftOut) {
  const LiveRig rig("euroc", 2, 0.3);
  CameraGuide guide(rig.guideRig(), {});
  const auto decisions = test::playWandering(guide, rig, 80, 10, [](GuideFrame& frame) {
    if (frame.index != 70) return;
    for (auto& corners : frame.corners) {  // tags in the wrong order
      for (std::size_t i = 0; i < corners.size() / 2; ++i) {
        std::swap(corners[i].uv, corners[corners.size() - 1 - i].uv);
      }
      for (std::size_t i = 0; i < corners.size(); i += 3) corners[i].uv.x() += 40;
    }
  });
  EXPECT_EQ(decisions[70].reason, GuideReason::kNoPose);
  EXPECT_FALSE(decisions[70].accepted);
  EXPECT_EQ(decisions[70].views_kept, decisions[69].views_kept);
  EXPECT_NE(decisions[71].reason, GuideReason::kNoPose);
}

TEST(CameraGuide, OneCameraIsEnoughForAView) {
  const LiveRig rig("euroc", 2, 0.3);
  CameraGuide guide(rig.guideRig(), {});
  const auto decisions = test::playWandering(guide, rig, 60, 10, [](GuideFrame& frame) {
    if (frame.index >= 20 && frame.index % 2 == 0) frame.corners[0].clear();
  });
  int accepted = 0;
  for (std::size_t i = 20; i < 60; i += 2) {
    EXPECT_TRUE(decisions[i].T_FC0.has_value());
    EXPECT_LT((decisions[i].T_FC0->t - rig.wandering(0.1 * static_cast<double>(i)).t).norm(), 0.02);
    accepted += decisions[i].accepted ? 1 : 0;
  }
  EXPECT_GT(accepted, 2);
}

TEST(CameraGuide, StampsThatGoBackAndPausesAreSaid) {
  const LiveRig rig("euroc", 3, 0.3);
  CameraGuide guide(rig.guideRig(), {});
  const auto decisions = test::playWandering(guide, rig, 60, 10, [](GuideFrame& frame) {
    if (frame.index == 40) frame.t -= 5'000'000'000;
    if (frame.index >= 50) frame.t += 3'000'000'000;
  });
  EXPECT_EQ(decisions[40].reason, GuideReason::kTimeJump);
  EXPECT_NE(decisions[40].detail.find("4.900000 s before"), std::string::npos)
      << decisions[40].detail;
  EXPECT_EQ(decisions[40].entropy_nats, decisions[39].entropy_nats);
  EXPECT_NE(decisions[41].reason, GuideReason::kTimeJump);
  EXPECT_NE(decisions[50].detail.find("no frame for 3.100 s"), std::string::npos)
      << decisions[50].detail;
  EXPECT_NE(decisions[50].reason, GuideReason::kTimeJump);
}

TEST(CameraGuide, DropsFramesThatComeWhileItIsBusy) {
  const LiveRig rig("euroc", 4, 0.3);
  GuideOptions options;
  options.latency.camera_frame_s = 0.25;
  options.latency.next_view_s = 0.4;
  CameraGuide guide(rig.guideRig(), options);
  EXPECT_LT(guide.busyUntil(), rig.start());
  TimeNs busy = 0;
  int dropped = 0;
  int rounds = 0;
  Decision before;
  for (int i = 0; i < 600; ++i) {
    const GuideFrame frame = rig.frame(i, 0.1 * i, rig.wandering(0.1 * i));
    const Decision d = guide.step(frame);
    ASSERT_EQ(d.reason == GuideReason::kBusy, frame.t < busy) << i;
    if (d.reason == GuideReason::kBusy) {
      ++dropped;
      EXPECT_FALSE(d.accepted);
      EXPECT_EQ(d.mode, before.mode);
      EXPECT_EQ(d.views_kept, before.views_kept);
      EXPECT_EQ(d.entropy_nats, before.entropy_nats);
    } else {
      busy = frame.t + 250'000'000;
      if (d.round) {
        ++rounds;
        busy += 400'000'000;
        EXPECT_EQ(d.round->asked, frame.t);
        EXPECT_EQ(d.round->answered, busy);
        if (d.opened) {
          EXPECT_EQ(d.opened->t, busy);
        }
      }
    }
    EXPECT_EQ(guide.busyUntil(), busy);
    before = d;
  }
  EXPECT_GT(rounds, 0);
  EXPECT_NEAR(dropped, 400, 10);
}

TEST(CameraGuide, FinishingCostsTheBatch) {
  const LiveRig rig("euroc", 5, 0.3);
  GuideOptions options;
  options.views.threshold_nats = 1;
  options.latency.camera_batch_s = 7;
  CameraGuide guide(rig.guideRig(), options);
  const auto decisions = test::playGuided(guide, rig, 2000);
  ASSERT_TRUE(guide.finished());
  EXPECT_EQ(guide.busyUntil(), decisions.back().t + 7'000'000'000);
}

/// A free motion of which one frame holds corners that no camera could see from anywhere.
std::vector<Decision> playedWithWrongFrame(const LiveRig& rig, int index) {
  CameraGuide guide(rig.guideRig(), {});
  return test::playWandering(guide, rig, 60, 10, [&](GuideFrame& frame) {
    if (frame.index != index) return;
    for (auto& corners : frame.corners) {
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const auto i = static_cast<double>(k);
        corners[k].uv = {std::fmod(331 * i, 740), std::fmod(173 * i, 470)};
      }
    }
  });
}
const Decision& startOf(const std::vector<Decision>& decisions) {
  return *std::find_if(decisions.begin(), decisions.end(),
                       [](const Decision& d) { return d.reason == GuideReason::kInitialised; });
}

TEST(CameraGuide, AFrameWithoutPlausiblePoseLeavesWithTheStart) {
  const LiveRig rig("euroc", 6, 0.3);
  const auto decisions = playedWithWrongFrame(rig, 2);
  ASSERT_EQ(test::countOf(decisions, GuideReason::kInitialised), 1);
  const Decision& start = startOf(decisions);
  EXPECT_TRUE(decisions[2].accepted);
  EXPECT_EQ(start.withdrawn, std::vector<int>{2});
  EXPECT_NE(start.detail.find("frame 2: no plausible pose"), std::string::npos) << start.detail;
  ASSERT_TRUE(start.T_FC0);
  const Transform truth = rig.wandering(0.1 * static_cast<double>(start.frame));
  EXPECT_LT((start.T_FC0->t - truth.t).norm(), 0.05);
  int kept = 0;
  for (const Decision& d : decisions) {
    kept += (d.accepted ? 1 : 0) - static_cast<int>(d.withdrawn.size());
  }
  EXPECT_EQ(kept, decisions.back().views_kept);
}

TEST(CameraGuide, TheFrameThatStartsItMayItselfBeLeftOut) {
  const LiveRig rig("euroc", 6, 0.3);
  const auto decisions = playedWithWrongFrame(rig, 4);
  ASSERT_EQ(test::countOf(decisions, GuideReason::kInitialised), 1);
  const Decision& start = startOf(decisions);
  ASSERT_EQ(start.frame, 4);
  EXPECT_FALSE(start.accepted);
  EXPECT_FALSE(start.T_FC0);
  EXPECT_TRUE(start.withdrawn.empty());
  EXPECT_NE(start.detail.find("no plausible pose"), std::string::npos) << start.detail;
  EXPECT_EQ(start.views_kept, 4);
}

// The first frames are shrunk into a corner of the image: another lens explains them, and none of
// the frames that follow.
TEST(CameraGuide, StartsAnewWhereTheStartExplainsNoneOfTheFramesThatFollow) {
  const LiveRig rig("euroc", 7, 0.3);
  GuideOptions options;
  options.views.start_move_px = 4;
  CameraGuide guide(rig.guideRig(), options);
  const auto decisions = test::playWandering(guide, rig, 90, 10, [&](GuideFrame& frame) {
    if (frame.index >= 9) return;
    for (auto& corners : frame.corners) {
      for (Corner& corner : corners) corner.uv = 0.4 * corner.uv + Eigen::Vector2d(20, 250);
    }
  });
  const auto given_up = std::find_if(decisions.begin(), decisions.end(), [](const Decision& d) {
    return d.detail.find("restarts") != std::string::npos;
  });
  ASSERT_NE(given_up, decisions.end());
  EXPECT_EQ(given_up->reason, GuideReason::kInitialiseFailed);
  EXPECT_EQ(given_up->mode, GuideMode::kInitialising);
  EXPECT_FALSE(given_up->withdrawn.empty());
  EXPECT_EQ(given_up->views_kept, 0);
  EXPECT_FALSE(given_up->entropy_nats);
  EXPECT_EQ(test::countOf(decisions, GuideReason::kInitialised), 2);
  const auto batch = guide.batch();
  ASSERT_TRUE(batch) << batch.failure();
  EXPECT_NEAR(batch->cameras[0].intrinsics.projection(0), rig.truth()[0].intrinsics.projection(0),
              5);
}

// The first frames are through a lens of 0.8 times the focal length. All that follow have
// plausible poses under it, so that only a start from other frames tells that it was wrong.
std::vector<Decision> playedFromAWrongStart(CameraGuide& guide, const LiveRig& rig, double scale) {
  return test::playWandering(guide, rig, 120, 10, [&](GuideFrame& frame) {
    if (frame.index >= 5) return;
    for (auto& corners : frame.corners) {
      const Eigen::Vector2d centre(370, 250);
      for (Corner& corner : corners) corner.uv = centre + scale * (corner.uv - centre);
    }
  });
}

TEST(CameraGuide, StartsAnewWhereARestartFromOtherFramesDisagrees) {
  const LiveRig rig("euroc", 7, 0.3);
  GuideOptions options;
  options.views.start_move_px = 4;
  CameraGuide guide(rig.guideRig(), options);
  const auto decisions = playedFromAWrongStart(guide, rig, 0.8);
  const auto given_up = std::find_if(decisions.begin(), decisions.end(), [](const Decision& d) {
    return d.detail.find("restarts") != std::string::npos;
  });
  ASSERT_NE(given_up, decisions.end());
  EXPECT_NE(given_up->detail.find("px RMSE on 10 frames after its start"), std::string::npos)
      << given_up->detail;
  EXPECT_EQ(given_up->reason, GuideReason::kInitialiseFailed);
  EXPECT_EQ(given_up->views_kept, 0);
  EXPECT_FALSE(given_up->T_FC0) << "a pose under cameras that were wrong";
  for (auto d = decisions.begin(); d != given_up; ++d) {
    EXPECT_NE(d->reason, GuideReason::kNoPose) << "poses were plausible: " << d->frame;
  }
  // The view of the first frame, which nobody has gone to, was drawn by cameras that were wrong.
  ASSERT_TRUE(decisions.front().opened);
  const int first = decisions.front().opened->id;
  EXPECT_EQ(std::prev(given_up)->suggestion, first);
  EXPECT_EQ(given_up->event, SuggestionEvent::kWithdrawn);
  EXPECT_EQ(given_up->suggestion, first);
  const auto next = std::find_if(std::next(given_up), decisions.end(),
                                 [](const Decision& d) { return d.suggestion.has_value(); });
  ASSERT_NE(next, decisions.end());
  EXPECT_EQ(next->event, SuggestionEvent::kOpened);
  EXPECT_EQ(next->suggestion, first + 1);
  EXPECT_NE(next->mode, GuideMode::kInitialising) << "asked before the new start stands";
  const auto batch = guide.batch();
  ASSERT_TRUE(batch) << batch.failure();
  EXPECT_NEAR(batch->cameras[0].intrinsics.projection(0), rig.truth()[0].intrinsics.projection(0),
              3);
}

TEST(CameraGuide, EachAttemptToStartCosts) {
  const LiveRig rig("euroc", 5, 0.3);
  GuideOptions options;
  options.latency.camera_start_s = 0.5;
  CameraGuide guide(rig.guideRig(), options);
  const auto decisions = test::playWandering(guide, rig, 60, 10);
  for (std::size_t i = 0; i + 5 < decisions.size(); ++i) {
    if (decisions[i].reason != GuideReason::kInitialised &&
        decisions[i].reason != GuideReason::kInitialiseFailed) {
      continue;
    }
    for (std::size_t k = 1; k < 5; ++k) EXPECT_EQ(decisions[i + k].reason, GuideReason::kBusy);
    EXPECT_NE(decisions[i + 5].reason, GuideReason::kBusy);
  }
  EXPECT_EQ(test::countOf(decisions, GuideReason::kInitialised), 1);
}

}  // namespace
}  // namespace plumbline
