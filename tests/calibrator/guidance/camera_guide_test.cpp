// SPDX-License-Identifier: BSD-3-Clause
#include <limits>

#include <gtest/gtest.h>

#include "calibrator/guidance/guide.h"
#include "tests/calibrator/guidance/camera_guide_replay.h"

namespace plumbline {
namespace {

using test::guideOptions, test::kGuideSigma, test::LiveRig;

TEST(CameraGuide, EveryViewKeptReachesTheThresholdAndEveryOtherDoesNot) {
  const LiveRig rig("euroc", 6, kGuideSigma);
  CameraGuide guide(rig.guideRig(), guideOptions());
  const auto decisions = test::playWandering(guide, rig, 200, 10);
  double entropy = std::numeric_limits<double>::infinity();
  int kept = 0;
  for (const Decision& d : decisions) {
    if (d.accepted) ++kept;
    EXPECT_EQ(d.views_kept, kept);
    if (!d.mi_nats) continue;
    EXPECT_EQ(d.accepted, *d.mi_nats >= d.threshold_nats);
    EXPECT_EQ(d.reason, d.accepted ? GuideReason::kInformative : GuideReason::kNotInformative);
    EXPECT_EQ(d.frames_without_view == 0, d.accepted);
    if (d.accepted) {
      EXPECT_LT(*d.entropy_nats, entropy);
    }
    entropy = *d.entropy_nats;
  }
  EXPECT_GT(test::countOf(decisions, GuideReason::kNotInformative), 20);
  EXPECT_GT(test::countOf(decisions, GuideReason::kInformative), 20);
}

TEST(CameraGuide, GainOfAFrameIsWhatTheEntropyLoses) {
  const LiveRig rig("euroc", 7, kGuideSigma);
  CameraGuide guide(rig.guideRig(), guideOptions());
  const auto decisions = test::playWandering(guide, rig, 120, 10);
  double promised = 0;
  double lost = 0;
  for (std::size_t i = 1; i < decisions.size(); ++i) {
    if (decisions[i].reason != GuideReason::kInformative) continue;
    promised += *decisions[i].mi_nats;
    lost += *decisions[i - 1].entropy_nats - *decisions[i].entropy_nats;
  }
  EXPECT_GT(promised, 5);
  EXPECT_NEAR(lost, promised, 0.05 * promised);
}

TEST(CameraGuide, DecidesTheSameWithTwoThreads) {
  const LiveRig rig("euroc", 8, kGuideSigma);
  const auto run = [&](int threads) {
    GuideOptions options;  // with the loss
    options.threads = threads;
    CameraGuide guide(rig.guideRig(), options);
    return test::textOf(test::playGuided(guide, rig, 100));
  };
  const std::string one = run(1);
  EXPECT_NE(one.find("opened"), std::string::npos);
  EXPECT_EQ(one, run(2));
}

TEST(CameraGuide, NumbersSuggestionsFromTheGivenOne) {
  const LiveRig rig("euroc", 9, kGuideSigma);
  CameraGuide guide(rig.guideRig(), guideOptions(), 7);
  const auto decisions = test::playGuided(guide, rig, 60);
  for (const Decision& d : decisions) {
    if (d.opened) {
      EXPECT_EQ(d.opened->id, 7);
      return;
    }
  }
  FAIL() << "no suggestion";
}

}  // namespace
}  // namespace plumbline
