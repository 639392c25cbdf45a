// SPDX-License-Identifier: BSD-3-Clause
// The best stop in hindsight: the expected error is that of the noise, the crossing is one, and the
// recording that goes on is the same up to the stop.
#include "evaluate/simulation/stop_hindsight.h"

#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <gtest/gtest.h>

#include "calibrator/simulate/rig.h"
#include "evaluate/simulation/operator_convergence.h"

namespace plumbline {
namespace {

const SimulatedRig& hindsightRig() {
  static const SimulatedRig rig = simulatedRig("euroc");
  return rig;
}

OperatedOptions stoppedAt(double px, std::uint64_t seed) {
  OperatedOptions o;
  o.simulation.duration_s = 20;
  o.simulation.seed = o.operator_seed = seed;
  o.trajectories = 1;
  o.guide.views.stop_projection_px = px;
  return o;
}

/// What stoppedAt() records, which several tests look at.
const OperatedSession& recordedTo(double px, std::uint64_t seed) {
  static std::map<std::pair<double, std::uint64_t>, OperatedSession> recorded;
  const auto [at, is_new] = recorded.try_emplace({px, seed});
  if (is_new) at->second = recordGuided(hindsightRig(), stoppedAt(px, seed));
  return at->second;
}

TEST(StopHindsight, TheExpectedErrorIsThatOfDraws) {
  const OperatedOptions o = stoppedAt(0.1, 1);
  const OperatedSession& s = recordedTo(0.1, 1);
  const auto views = keptViews(s).back().frames;
  const auto px = expectedProjectionPx({s, o, hindsightRig()}, views);
  const auto drawn = drawnProjectionPx({s, o, hindsightRig()}, views, 40);
  ASSERT_TRUE(px && drawn);
  EXPECT_NEAR(*drawn / *px, 1, 0.2);  // 40 draws: std 0.07
  OperatedOptions noisier = o;
  noisier.simulation.corner_sigma_px *= 2;
  EXPECT_NEAR(*expectedProjectionPx({s, noisier, hindsightRig()}, views) / *px, 2, 1e-6);
  EXPECT_NEAR(*drawnProjectionPx({s, noisier, hindsightRig()}, views, 40) / *drawn, 2, 0.1)
      << "the same draws, twice as large";
}

TEST(StopHindsight, ANoiseThatIsNoNumberIsNoErrorOfZero) {
  OperatedOptions o = stoppedAt(0.1, 1);
  const OperatedSession& s = recordedTo(0.1, 1);
  const auto views = keptViews(s).back().frames;
  o.simulation.corner_sigma_px = std::numeric_limits<double>::quiet_NaN();
  const auto px = expectedProjectionPx({s, o, hindsightRig()}, views);
  ASSERT_TRUE(px);
  EXPECT_TRUE(std::isnan(*px)) << *px;
}

// A board that is not as it is taken to be: an error that no view takes away.
TEST(StopHindsight, AWrongBoardIsPartOfTheExpectedError) {
  OperatedOptions o = stoppedAt(0.1, 1);
  o.simulation.target.shape.terms[8] = 1e-3;  // z_xx, RMS
  o.guide_shape = o.simulation.target.shape;
  const OperatedSession s = recordGuided(hindsightRig(), o);
  const auto views = keptViews(s).back().frames;
  OperatedOptions flat = o;
  flat.guide_shape = {};
  EXPECT_GT(*expectedProjectionPx({s, flat, hindsightRig()}, views),
            2 * *expectedProjectionPx({s, o, hindsightRig()}, views));
}

TEST(StopHindsight, KeptViewsAreThoseOfTheDecisions) {
  const OperatedSession& s = recordedTo(0.1, 1);
  const auto kept = keptViews(s);
  ASSERT_GE(kept.size(), 8u);
  EXPECT_TRUE(kept.back().finished);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const auto frame = static_cast<std::size_t>(kept[i].frames.back());
    EXPECT_EQ(static_cast<int>(kept[i].frames.size()), s.decisions[frame].views_kept);
    EXPECT_EQ(kept[i].predicted_px, s.decisions[frame].projection_px);
    if (i > 0) {
      EXPECT_GT(kept[i].t_s, kept[i - 1].t_s);
    }
  }
}

// Over persons the guide predicts what is expected, at its stop; and the best time is where the
// expected error crosses the bar.
TEST(StopHindsight, ThePredictionAtTheStopIsTheExpectedError) {
  HindsightOptions few;
  few.draws = 2;
  int stops = 0;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const OperatedOptions o = stoppedAt(0.1, seed);
    const OperatedSession& s = recordedTo(0.1, seed);
    const auto stop = stopHindsight({s, o, hindsightRig()}, GuideStage::kCamera, few);
    if (!stop || !stop->expected_px) continue;
    ++stops;
    EXPECT_LE(stop->predicted_px, 0.1);
    EXPECT_NEAR(std::log(stop->predicted_px / *stop->expected_px), 0, 0.2);
    ASSERT_TRUE(stop->best_s);
    const double stopped_s = keptViews(s).back().t_s;
    EXPECT_EQ(*stop->best_s <= stopped_s, *stop->expected_px <= 0.1);
    EXPECT_LE(stop->best_views, *stop->best_s <= stopped_s ? stop->views : 1000);
  }
  EXPECT_EQ(stops, 2);
}

/// Both stages end by a bar; that of the cameras early, for here the other matters.
OperatedOptions imuStoppedAt(double px, std::uint64_t seed) {
  OperatedOptions o = stoppedAt(0.1, seed);
  o.simulation.duration_s = 40;
  o.trajectories = 0;
  o.guide.trajectories.stop_reprojection_px = px;
  return o;
}

/// What imuStoppedAt(0.5, 1) records.
const OperatedSession& recordedToTheImuStop() {
  static const OperatedSession s = recordGuided(hindsightRig(), imuStoppedAt(0.5, 1));
  return s;
}

std::vector<int> framesAtTheImuStop(const OperatedSession& s) {
  return keptViews(s, GuideStage::kCameraImu).back().frames;
}

TEST(StopHindsight, TheExpectedErrorOfThePointsIsThatOfDraws) {
  OperatedOptions o = imuStoppedAt(0.5, 1);
  const OperatedSession& s = recordedToTheImuStop();
  const auto frames = framesAtTheImuStop(s);
  const auto px = expectedReprojectionPx({s, o, hindsightRig()}, frames);
  const auto drawn = drawnReprojectionPx({s, o, hindsightRig()}, frames, 40);
  ASSERT_TRUE(px && drawn);
  EXPECT_NEAR(*drawn / *px, 1, 0.25);  // 40 draws of some 3 degrees of freedom: std 0.09
  // Corners with three times the noise that the weights assume.
  o.guide.trajectories.pixel_sigma = 0.2;
  o.guide.trajectories.cauchy_px = 0;
  o.simulation.corner_sigma_px = 0.6;
  const auto noisy = expectedReprojectionPx({s, o, hindsightRig()}, frames);
  const auto noisy_drawn = drawnReprojectionPx({s, o, hindsightRig()}, frames, 40);
  ASSERT_TRUE(noisy && noisy_drawn);
  EXPECT_GT(*noisy, 1.02 * *px);
  EXPECT_NEAR(*noisy_drawn / *noisy, 1, 0.25);
}

TEST(StopHindsight, AWrongBoardIsPartOfTheExpectedErrorOfThePoints) {
  OperatedOptions o = imuStoppedAt(0.5, 1);
  o.simulation.target.shape.terms[8] = 3e-3;  // z_xx, RMS
  o.guide_shape = o.simulation.target.shape;
  const OperatedSession s = recordGuided(hindsightRig(), o);
  const auto frames = framesAtTheImuStop(s);
  OperatedOptions flat = o;
  flat.guide_shape = {};
  EXPECT_GT(*expectedReprojectionPx({s, flat, hindsightRig()}, frames),
            1.5 * *expectedReprojectionPx({s, o, hindsightRig()}, frames));
}

TEST(StopHindsight, KeptFramesOfTheImuStageAreThoseOfItsDecisions) {
  const OperatedSession& s = recordedToTheImuStop();
  const auto kept = keptViews(s, GuideStage::kCameraImu);
  ASSERT_GE(kept.size(), 20u);
  EXPECT_TRUE(kept.back().finished);
  EXPECT_NEAR(kept.back().t_s, s.camera_imu_s, 0.06) << "since the stage began";
  for (const KeptViews& k : kept) {
    const Decision& d = s.decisions[static_cast<std::size_t>(k.frames.back())];
    EXPECT_EQ(d.stage, GuideStage::kCameraImu);
    EXPECT_EQ(static_cast<int>(k.frames.size()), d.views_kept);
    EXPECT_EQ(k.predicted_px, d.error_px);
  }
}

// Corners of 0.2 px under weights for 1 px: the rule goes by what is expected all the same.
TEST(StopHindsight, TheImuStageStopsWhereTheExpectedErrorIsWithinTheBar) {
  HindsightOptions few;
  few.draws = 1;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const OperatedOptions o = imuStoppedAt(0.2, seed);
    const OperatedSession s = recordGuided(hindsightRig(), o);
    const auto stop = stopHindsight({s, o, hindsightRig()}, GuideStage::kCameraImu, few);
    ASSERT_TRUE(stop && stop->expected_px && stop->best_s) << seed;
    EXPECT_LE(stop->predicted_px, 0.2);
    EXPECT_NEAR(stop->predicted_px / *stop->expected_px, 1, 0.05) << seed;
    EXPECT_EQ(*stop->best_s <= stop->stopped_s, *stop->expected_px <= 0.2);
    EXPECT_NEAR(stop->stopped_s / *stop->best_s, 1, 0.1) << seed;
  }
}

// Judged by another bar than the guide was told, its stop is too early: the recording goes on.
TEST(StopHindsight, AnEarlyStopOfTheImuStageIsContinued) {
  const OperatedOptions o = imuStoppedAt(0.5, 2);
  OperatedOptions stricter = o;
  stricter.guide.trajectories.stop_reprojection_px = 0.4;
  HindsightOptions few;
  few.draws = 1;
  const auto stop = stopHindsight({recordGuided(hindsightRig(), o), stricter, hindsightRig()},
                                  GuideStage::kCameraImu, few);
  ASSERT_TRUE(stop && stop->best_s);
  EXPECT_GT(*stop->expected_px, 0.4);
  EXPECT_GT(*stop->best_s, stop->stopped_s);
  EXPECT_GT(*stop->best_views, stop->views);
  EXPECT_NEAR(*stop->predicted_at_best_px, 0.4, 0.04);
}

// No number of views makes up for a board that is not as it is taken to be: there is no time to
// name, and what is expected in the end says so.
TEST(StopHindsight, ABarThatIsNeverReachedHasNoBestTime) {
  OperatedOptions o = stoppedAt(0.1, 1);
  o.simulation.target.shape.terms[8] = 3e-3;  // z_xx, RMS
  o.guide_shape = o.simulation.target.shape;
  const OperatedSession s = recordGuided(hindsightRig(), o);
  OperatedOptions flat = o;
  flat.guide_shape = {};
  HindsightOptions few;
  few.draws = 1;
  const auto stop = stopHindsight({s, flat, hindsightRig()}, GuideStage::kCamera, few);
  ASSERT_TRUE(stop);
  EXPECT_FALSE(stop->best_s);
  ASSERT_TRUE(stop->searched_s && stop->expected_at_end_px);
  EXPECT_GT(*stop->searched_s, 0);
  EXPECT_GT(*stop->expected_at_end_px, 0.1);
}

TEST(StopHindsight, TheRecordingThatGoesOnIsTheSameUpToTheStop) {
  const OperatedOptions o = stoppedAt(0.2, 3);
  OperatedOptions longer = o;
  longer.guide.views.stop_projection_px = 0.1;
  longer.simulation.duration_s = 10;
  const auto first = keptViews(recordGuided(hindsightRig(), o));
  const auto second = keptViews(recordGuided(hindsightRig(), longer));
  ASSERT_LT(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].frames, second[i].frames);
    EXPECT_EQ(first[i].predicted_px, second[i].predicted_px);
  }
}

TEST(StopHindsight, NothingWithoutThatStop) {
  for (const double px : {0.0, 1e-3}) {  // not asked for, not reached
    OperatedOptions o = stoppedAt(px, 1);
    o.simulation.duration_s = 6;
    EXPECT_FALSE(
        stopHindsight({recordGuided(hindsightRig(), o), o, hindsightRig()}, GuideStage::kCamera))
        << px;
    o = imuStoppedAt(px, 1);
    o.simulation.duration_s = 10;
    EXPECT_FALSE(
        stopHindsight({recordGuided(hindsightRig(), o), o, hindsightRig()}, GuideStage::kCameraImu))
        << px;
  }
}

}  // namespace
}  // namespace plumbline
