// SPDX-License-Identifier: BSD-3-Clause
// The camera-IMU stage by predicted error: what it asks for, and when it stops.
#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "calibrator/guidance/guide.h"
#include "calibrator/guidance/imu_stage_tracker.h"
#include "tests/calibrator/guidance/imu_guide_replay.h"

namespace plumbline {
namespace {

using test::byTrajectoryError;

const SimulatedSession& recording() {
  static const SimulatedSession s = test::flight(8, 1);
  return s;
}

std::vector<Decision> replayed(const GuideOptions& options) {
  CameraImuGuide guide(test::rigOf(recording()), recording().truth.cameras, options);
  return test::replay(guide, test::framesOf(recording().session));
}

TEST(CameraImuGuideByError, AsksForTheTrajectoryThatLeavesLeast) {
  GuideOptions options = byTrajectoryError();
  options.trajectories.least_lowering = 1e-6;
  std::optional<double> first, last;
  int rounds = 0, opened = 0;
  for (const Decision& d : replayed(options)) {
    if (d.error_px) last = d.error_px;
    if (!first) first = last;
    if (d.opened) {
      EXPECT_EQ(*d.opened->error_px, d.round->error_px[static_cast<std::size_t>(d.round->best)]);
      EXPECT_LT(*d.opened->error_px, *d.error_px);
      ++opened;
    }
    if (!d.round) continue;
    ++rounds;
    const auto& errors = d.round->error_px;
    ASSERT_EQ(errors.size(), d.round->mi_nats.size());
    EXPECT_EQ(errors[static_cast<std::size_t>(d.round->best)],
              *std::min_element(errors.begin(), errors.end()));
  }
  EXPECT_GE(rounds, 5);
  EXPECT_GE(opened, 1);
  EXPECT_LT(*last, 0.5 * *first);  // eight seconds of motion sharpen it
}

TEST(CameraImuGuideByError, StopsWhereNoTrajectoryLowersTheErrorByAsMuchAsAskedFor) {
  GuideOptions options = byTrajectoryError();
  options.trajectories.least_lowering = 0.5;
  const auto decisions = replayed(options);
  const auto end = std::find_if(decisions.begin(), decisions.end(),
                                [](const Decision& d) { return d.mode == GuideMode::kFinished; });
  ASSERT_NE(end, decisions.end());
  ASSERT_TRUE(end->round);
  EXPECT_GT(end->frame, 40);
  // The round before it was worth a suggestion, this one was not.
  for (auto d = decisions.begin(); d <= end; ++d) {
    if (!d->round) continue;
    const double with = d->round->error_px[static_cast<std::size_t>(d->round->best)];
    const double share = std::pow(with / *d->error_px, 2);
    if (d == end) {
      EXPECT_GT(share, 0.5);
    } else {
      EXPECT_LE(share, 0.5);
    }
  }
}

TEST(CameraImuGuideByError, StopsWhenAndOnlyWhenTheErrorIsWhatWasAskedFor) {
  for (const auto criterion : {ViewCriterion::kMutualInformation, ViewCriterion::kPredictedError}) {
    GuideOptions options = byTrajectoryError();
    options.trajectories.criterion = criterion;
    options.trajectories.threshold_nats = 5;     // by which it would stop at once,
    options.trajectories.least_lowering = 0.99;  // or by this
    options.trajectories.stop_reprojection_px = 0.3;
    bool finished = false;
    for (const Decision& d : replayed(options)) {
      if (finished || !d.error_px) continue;
      EXPECT_EQ(d.mode == GuideMode::kFinished, *d.error_px <= 0.3);
      EXPECT_EQ(*d.error_bound_px, 0.3);
      finished = d.mode == GuideMode::kFinished;
    }
    EXPECT_TRUE(finished);
  }
}

// Without an answer of what the noise is there is no stop, however small the error by the noise
// assumed; the predictions are there all the same.
TEST(CameraImuGuideByError, DoesNotStopBeforeTheNoiseIsJudged) {
  GuideOptions options = byTrajectoryError();
  options.trajectories.stop_reprojection_px = 1000;
  const auto stopsAt = [&](double latency_s) {
    options.latency.imu_batch_s = latency_s;
    for (const Decision& d : replayed(options)) {
      if (d.mode == GuideMode::kFinished)
        return secondsBetween(recording().session.imu->samples.front().t, d.t);
    }
    return std::numeric_limits<double>::infinity();
  };
  EXPECT_LT(stopsAt(0), 3);
  EXPECT_NEAR(stopsAt(2) - stopsAt(0), 2, 0.06);  // a frame more
}

}  // namespace
}  // namespace plumbline
