// SPDX-License-Identifier: BSD-3-Clause
// What is said of a simulated operator's recording: what is known, and no more.
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluate/simulation/simulate_operator.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

OperatorSimulationSummary stoppedCameras(const StopHindsight& stop) {
  OperatorSimulationSummary made;
  made.camera_s = 20;
  made.convergence.emplace();
  made.stops.cameras = stop;
  return made;
}

StopHindsight earlyStop() {
  StopHindsight stop;
  stop.stopped_s = 12;
  stop.predicted_px = 0.09;
  stop.expected_px = 0.12;
  return stop;
}

TEST(OperatorJudgement, NamesTheBestStopWhereThereIsOne) {
  StopHindsight stop = earlyStop();
  stop.best_s = 14.25;
  EXPECT_THAT(judgementText(stoppedCameras(stop)),
              HasSubstr("Camera stage: stopped after 12.0 s, predicted 0.090 px, expected 0.120 "
                        "px; best stop: after 14.2 s\n"));
}

// Views may never be enough, as before a board of another shape: nobody knows of a later time.
TEST(OperatorJudgement, AnErrorThatStaysAboveTheBarIsNoLaterStop) {
  StopHindsight stop = earlyStop();
  stop.searched_s = 36;
  stop.expected_at_end_px = 0.115;
  EXPECT_THAT(judgementText(stoppedCameras(stop)),
              HasSubstr("best stop: none within 36.0 s, with whose views 0.115 px are expected\n"));
}

TEST(OperatorJudgement, AnErrorThatIsNotKnownIsNoLaterStop) {
  StopHindsight stop = earlyStop();
  stop.searched_s = 36;
  for (const std::optional<double> none :
       {std::optional<double>(), std::optional(std::numeric_limits<double>::quiet_NaN())}) {
    stop.expected_px = stop.expected_at_end_px = none;
    EXPECT_THAT(judgementText(stoppedCameras(stop)),
                HasSubstr("predicted 0.090 px, expected unknown; best stop: unknown\n"));
  }
}

TEST(OperatorJudgement, WhatIsNotCalibratedAtTheEndIsNotCalledInaccurate) {
  OperatorSimulationSummary made = stoppedCameras(earlyStop());
  StageConvergence& cameras = made.convergence->cameras;
  cameras.points.push_back({2, 10, 0.4, {}, {}, {}, false});
  cameras.at_end = ConvergencePoint{4, 20, {}, {}, {}, {}, false};
  EXPECT_THAT(judgementText(made), HasSubstr("Cameras (0.1 px): not calibrated at the end\n"));
  cameras.at_end->projection_px = 0.3;
  EXPECT_THAT(judgementText(made), HasSubstr("Cameras (0.1 px): not accurate at the end\n"));
  cameras.right_s = 2;
  cameras.right_views = 10;
  EXPECT_THAT(judgementText(made),
              HasSubstr("accurate after 2.0 s and 10 views, not accurate at the end\n"));
  cameras.at_end->right = true;
  EXPECT_THAT(judgementText(made), HasSubstr("accurate after 2.0 s and 10 views\n"));
}

TEST(OperatorJudgement, NothingIsSaidWhereNothingWasJudged) {
  EXPECT_EQ(judgementText(OperatorSimulationSummary()), "");
}

}  // namespace
}  // namespace plumbline
