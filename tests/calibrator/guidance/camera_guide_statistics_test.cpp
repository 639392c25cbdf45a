// SPDX-License-Identifier: BSD-3-Clause
// The camera stage over whole recordings: where it ends, and that a right start is never given up.
#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <optional>

#include <gtest/gtest.h>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/guidance/guide.h"
#include "tests/calibrator/guidance/camera_guide_replay.h"
#include "tests/calibrator/window/stereo_frames.h"

namespace plumbline {
namespace {

using test::guideOptions, test::kGuideSigma, test::LiveRig;

TEST(CameraGuide, FinishesAGuidedRecordingWithinItsCovarianceOfTheTruth) {
  for (const char* name : {"euroc", "tumvi"}) {
    const LiveRig rig(name, 5, kGuideSigma);
    CameraGuide guide(rig.guideRig(), guideOptions());
    const auto decisions = test::playGuided(guide, rig, 3000);
    ASSERT_TRUE(guide.finished()) << name;
    EXPECT_GT(test::countOf(decisions, SuggestionEvent::kReached), 2) << name;
    const Decision& last = decisions.back();
    EXPECT_EQ(last.mode, GuideMode::kFinished);
    ASSERT_TRUE(last.round.has_value());
    ASSERT_GE(last.round->best, 0);
    EXPECT_LT(last.round->mi_nats[static_cast<std::size_t>(last.round->best)], last.threshold_nats);
    const auto batch = guide.batch();
    ASSERT_TRUE(batch.ok()) << batch.failure();
    EXPECT_EQ(static_cast<int>(batch->frames.size()), last.views_kept);
    EXPECT_NEAR(batch->summary.reprojection.rmse_px, kGuideSigma * std::sqrt(2), 0.02);
    // Window and batch agree on what is known.
    EXPECT_NEAR(*last.entropy_nats, batch->summary.entropy_nats, 0.2);
    const Eigen::VectorXd error = cameraDifference(batch->cameras, rig.truth());
    const double nees = error.dot(batch->summary.covariance.matrix.llt().solve(error));
    EXPECT_GT(nees, 6.98) << name;  // chi-square of 22, two-sided 99.9 %
    EXPECT_LT(nees, 50.51) << name;
    EXPECT_EQ(guide.step(rig.frame(9999, 1e4, rig.wandering(0))).reason, GuideReason::kFinished);
  }
}

/// When the first view is asked for [s after the first frame].
double firstAskedAfter(int patience) {
  const LiveRig rig("euroc", 3, 0.2);
  GuideOptions options;
  options.views.patience = patience;
  CameraGuide guide(rig.guideRig(), options);
  const auto decisions = test::playGuided(guide, rig, 600);
  for (const Decision& d : decisions) {
    if (d.opened) return secondsBetween(decisions.front().t, d.t);
  }
  return std::numeric_limits<double>::infinity();
}

// The operator's own motion is informative for seconds; whoever is asked at once need not wait.
TEST(CameraGuide, AsksAtOnceWhereItHasNoPatience) {
  EXPECT_EQ(firstAskedAfter(0), 0);
  EXPECT_GT(firstAskedAfter(3), 1);
}

// Of cameras that nobody knows yet: the same view is asked for, and drawn by the estimate once it
// stands, so that whoever goes there reaches it.
TEST(CameraGuide, TheFirstViewIsReachedByTheEstimateThatStartsOnTheWay) {
  for (const char* name : {"euroc", "tumvi", "d435i"}) {
    const LiveRig rig(name, 3, 0.2);
    CameraGuide guide(rig.guideRig(), {});
    std::optional<Suggestion> first;
    SuggestionEvent end = SuggestionEvent::kNone;
    bool started_before_end = false;
    for (const Decision& d : test::playGuided(guide, rig, 200, 0)) {
      if (!first && d.opened) first = d.opened;
      if (end != SuggestionEvent::kNone || !d.suggestion || *d.suggestion != first->id) continue;
      if (d.event == SuggestionEvent::kNone || d.event == SuggestionEvent::kOpened) continue;
      end = d.event;
      EXPECT_NEAR(d.open_s, secondsBetween(first->t, d.t), 1e-9) << "what it took, in the log";
      EXPECT_GE(d.open_s, ViewGuideOptions().reached_s);
      started_before_end = d.mode != GuideMode::kInitialising;
    }
    ASSERT_TRUE(first) << name;
    EXPECT_EQ(first->mi_nats, 0) << "not scored";
    EXPECT_GT(first->reach_s.value_or(0), ViewGuideOptions().reached_s);
    EXPECT_EQ(end, SuggestionEvent::kReached) << name;
    EXPECT_TRUE(started_before_end) << name;
  }
}

TEST(CameraGuide, DoesNotStartAnewWhereTheStartWasRight) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    const LiveRig rig("euroc", seed, 0.5);
    CameraGuide guide(rig.guideRig(), {});
    const auto decisions = test::playWandering(guide, rig, 150, 10);
    EXPECT_EQ(test::countOf(decisions, GuideReason::kInitialised), 1) << seed;
    for (const Decision& d : decisions) EXPECT_TRUE(d.withdrawn.empty()) << seed;
  }
}

// Errors are then what the solver leaves, and their ratio means nothing.
TEST(CameraGuide, DoesNotStartAnewWhereCornersHaveNoNoise) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const LiveRig rig("euroc", seed, 0);
    CameraGuide guide(rig.guideRig(), {});
    const auto decisions = test::playWandering(guide, rig, 100, 10);
    EXPECT_EQ(test::countOf(decisions, GuideReason::kInitialised), 1) << seed;
  }
}

TEST(CameraGuide, KeepsAtLeastTheViewsAskedFor) {
  const LiveRig rig("euroc", 5, kGuideSigma);
  GuideOptions options = guideOptions();
  options.views.threshold_nats = 0.5;
  CameraGuide few(rig.guideRig(), options);
  test::playGuided(few, rig, 3000);
  ASSERT_TRUE(few.finished());
  const int views = static_cast<int>(few.batch()->frames.size());
  options.views.min_views = views + 20;
  CameraGuide more(rig.guideRig(), options);
  const auto decisions = test::playGuided(more, rig, 600);
  for (const Decision& d : decisions) {
    if (d.mode == GuideMode::kFinished) {
      EXPECT_GE(d.views_kept, views + 20);
    }
  }
  EXPECT_GT(decisions.back().views_kept, 0);
}

}  // namespace
}  // namespace plumbline
