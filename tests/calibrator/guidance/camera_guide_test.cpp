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
    return test::textOf(test::playGuided(guide, rig, 150));
  };
  const std::string one = run(1);
  EXPECT_NE(one.find("opened"), std::string::npos);
  EXPECT_EQ(one, run(2));
}

TEST(CameraGuide, SuggestionsExpireWhereNobodyFollows) {
  const LiveRig rig("euroc", 9, kGuideSigma);
  CameraGuide guide(rig.guideRig(), guideOptions());
  const auto decisions = test::playWandering(guide, rig, 450, 10);
  EXPECT_FALSE(guide.finished());
  EXPECT_GE(test::countOf(decisions, SuggestionEvent::kExpired), 2);
  std::optional<Suggestion> open;
  int accepted_while_open = 0;
  int next_id = 0;
  for (const Decision& d : decisions) {
    if (d.event == SuggestionEvent::kExpired) {
      ASSERT_TRUE(open.has_value());
      EXPECT_EQ(d.suggestion, open->id);
      EXPECT_NEAR(secondsBetween(open->t, d.t), 10.1, 1e-6);  // the first frame after 10 s
      open.reset();
    }
    if (d.opened) {
      EXPECT_FALSE(open.has_value());
      EXPECT_EQ(d.opened->id, next_id++);
      EXPECT_GE(d.frames_without_view, 3);
      ASSERT_TRUE(d.round.has_value());
      const auto best = static_cast<std::size_t>(d.round->best);
      EXPECT_EQ(d.opened->candidate, d.round->names[best]);
      // Of those that gain the same but for rounding the first is asked for (bestCandidate()).
      const double most = (1 + 1e-6) * d.opened->mi_nats;
      for (const double mi : d.round->mi_nats) EXPECT_FALSE(mi > most);
      open = d.opened;
    }
    EXPECT_EQ(d.mode == GuideMode::kSuggesting, open.has_value());
    if (open && d.accepted) ++accepted_while_open;
  }
  EXPECT_GT(accepted_while_open, 0);
  EXPECT_EQ(guide.nextSuggestion(), next_id);
}

TEST(CameraGuide, NumbersSuggestionsFromTheGivenOne) {
  const LiveRig rig("euroc", 9, kGuideSigma);
  CameraGuide guide(rig.guideRig(), guideOptions(), 7);
  const auto decisions = test::playGuided(guide, rig, 150);
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
