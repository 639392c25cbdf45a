// SPDX-License-Identifier: BSD-3-Clause
// The camera stage for fifteen seconds and more in which nobody follows: too long for sanitizers,
// under which camera_guide_test.cpp runs.
#include <optional>

#include <gtest/gtest.h>

#include "calibrator/guidance/guide.h"
#include "tests/calibrator/guidance/camera_guide_replay.h"

namespace plumbline {
namespace {

using test::guideOptions, test::kGuideSigma, test::LiveRig;

TEST(CameraGuide, SuggestionsExpireWhereNobodyFollows) {
  const LiveRig rig("euroc", 9, kGuideSigma);
  GuideOptions options = guideOptions();
  options.views.patience = 3;
  CameraGuide guide(rig.guideRig(), options);
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
      EXPECT_GE(d.frames_without_view, options.views.patience);
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

}  // namespace
}  // namespace plumbline
