// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/views/view_judge.h"

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "tests/calibrator/window/stereo_frames.h"

namespace plumbline {
namespace {

/// What a judge predicts of the projections after some frames, with so many times the information.
std::optional<double> projectionPxOf(const test::StereoFrames& frames, double times) {
  const AprilGrid& target = frames.simulated.session.target;
  CameraWindow window(target, frames.simulated.truth.cameras);
  for (std::size_t f = 0; f < 6; ++f) window.add(frames.corners[f], frames.T_FC0[f]);
  ViewGuideOptions options;
  options.stop_projection_px = 0.1;
  ViewJudge judge(target, options, 1);
  judge.refresh(window, times * window.information());
  Decision d;
  judge.tell(d);
  return d.projection_px;
}

TEST(ViewJudge, AnErrorThatIsNoNumberIsNotPredictedAsNone) {
  const test::StereoFrames frames = test::stereoFrames(1, 4, 2, 0.2);
  const auto px = projectionPxOf(frames, 1), half = projectionPxOf(frames, 4);
  ASSERT_TRUE(px && half);
  EXPECT_GT(*px, 0.01);
  EXPECT_NEAR(*half / *px, 0.5, 1e-9);
  EXPECT_FALSE(projectionPxOf(frames, std::numeric_limits<double>::quiet_NaN()));
}

/// A judge after the first `kept` frames, all of them kept, and the views that it may ask for.
struct JudgedFrames {
  test::StereoFrames frames;
  CameraWindow window;
  ViewJudge judge;
  std::vector<CandidateView> views;

  JudgedFrames(test::StereoFrames of, std::size_t kept, const ViewGuideOptions& options)
      : frames(std::move(of)),
        window(frames.simulated.session.target, frames.simulated.truth.cameras),
        judge(frames.simulated.session.target, options, 1),
        views(candidateViews(window.cameras(), frames.simulated.session.target)) {
    for (std::size_t f = 0; f < kept; ++f) keep(f);
  }
  void keep(std::size_t f) {
    window.add(frames.corners[f], frames.T_FC0[f]);
    judge.see(frames.corners[f], frames.T_FC0[f]);
    judge.keep(frames.corners[f], frames.T_FC0[f]);
    judge.refresh(window, window.information());
  }
};

// A candidate promises what its view would gain in full. Whoever was there without a frame worth
// keeping was asked for the same view again, and once more.
TEST(ViewJudge, AsksForNoViewTwiceUntilOneIsKept) {
  JudgedFrames now(test::stereoFrames(1, 4, 2, 0.2), 5, {});
  const CandidateRound first = now.judge.scored(now.views);
  const auto best = static_cast<std::size_t>(first.best);
  ASSERT_TRUE(now.judge.isWorthAsking(first, best));
  now.judge.reached(first.names[best]);
  const CandidateRound next = now.judge.scored(now.views);
  EXPECT_NE(next.best, first.best);
  EXPECT_EQ(next.mi_nats, first.mi_nats) << "the scores say what they said";
  EXPECT_FALSE(now.judge.isWorthAsking(next, best));
  EXPECT_TRUE(now.judge.isWorthAsking(next, static_cast<std::size_t>(next.best)));
  for (const std::string& name : first.names) now.judge.reached(name);
  EXPECT_EQ(now.judge.scored(now.views).best, first.best) << "where all were, the best of them";
  now.keep(5);
  const CandidateRound after = now.judge.scored(now.views);
  EXPECT_TRUE(now.judge.isWorthAsking(after, static_cast<std::size_t>(after.best)));
}

// Before views tell the misfit that all share from that of each by itself the predicted error
// stands on an even split of both: no reason to say that nothing is left to gain.
TEST(ViewJudge, DoesNotEndBeforeTheMisfitCanBeSeen) {
  ViewGuideOptions options;
  options.criterion = ViewCriterion::kPredictedError;
  options.stop_views = 2;
  options.least_lowering = 0.99;  // what no view does
  int apart = 0, together = 0;
  JudgedFrames now(test::stereoFrames(1, 8, 2, 0.2), 0, options);
  for (std::size_t f = 0; f < 14; ++f) {
    now.keep(f);
    Decision d;
    now.judge.tell(d);
    if (!d.error_px || f < 2) continue;
    const CandidateRound round = now.judge.scored(now.views);
    const bool asks = now.judge.isWorthAsking(round, static_cast<std::size_t>(round.best));
    EXPECT_EQ(asks, !now.judge.tellsMisfitApart()) << f;
    ++(asks ? together : apart);
  }
  EXPECT_GT(together, 0);
  EXPECT_GT(apart, 0);
}

TEST(ViewErrorTracker, RefusesOptionsOutOfRange) {
  ViewErrorOptions options;
  options.most_seen = 1;
  EXPECT_THROW(ViewErrorTracker(AprilGrid(), options), InputError);
}

}  // namespace
}  // namespace plumbline
