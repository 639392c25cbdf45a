// SPDX-License-Identifier: BSD-3-Clause
// Was the stop right? On a simulated recording, for decisions made up so that the answer is known.
#include "evaluate/replay/stops/stopping_rule.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "tests/evaluate/replay/decided_recording.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Stop = StopAudit::Verdict;

/// A recording of 20 s, and a guide that keeps every n-th frame of a stage and then says stop.
class Stopping : public DecidedRecording {
 protected:
  Stopping() : DecidedRecording(20, 10) {}

  void decide(GuideStage stage, int every, double stop_s) {
    for (const GuideFrame& frame : frames_) {
      const double t = secondsBetween(frames_.front().t, frame.t);
      Decision d;
      d.t = frame.t;
      d.frame = frame.index;
      d.stage = stage;
      d.corners = static_cast<int>(frame.corners[0].size() + frame.corners[1].size());
      d.accepted = t <= stop_s && frame.index % every == 0;
      d.reason = stopped_ ? GuideReason::kFinished : GuideReason::kInformative;
      d.mode = t >= stop_s ? GuideMode::kFinished : GuideMode::kCollecting;
      stopped_ = stopped_ || t >= stop_s;
      decisions_.push_back(d);
    }
  }

  StopAudit cameraAudit() const {
    const ReplayRun r = run();
    return judgeCameraStop(r, cameraBatches(r, keptCameras(r)));
  }

  StopAudit imuAudit(const StoppingRuleOptions& options = {}) const {
    const ReplayRun r = run();
    const auto& cameras = recording_.truth.cameras;
    return judgeCameraImuStop(r, cameras, cameraImuBatches(r, cameras), options);
  }

  bool stopped_ = false;
};

TEST_F(Stopping, LongAfterEnoughIsLate) {
  decide(GuideStage::kCamera, 2, 15);
  const StopAudit audit = cameraAudit();
  EXPECT_EQ(audit.verdict, Stop::kLate);
  ASSERT_TRUE(audit.enough.has_value());
  EXPECT_NEAR(audit.seconds, secondsBetween(*audit.enough, *audit.finished), 1e-9);
  EXPECT_GT(audit.seconds, 5);
  EXPECT_NEAR(audit.saved_s, 5, 0.2);
  // By how much more than the whole recording's the held-out error was: 0 would be none.
  EXPECT_NEAR(audit.measured_excess.value_or(1), 0, 0.05);
  EXPECT_LT(audit.entropy_of_all_nats, audit.entropy_at_finish_nats);
}

// On the same frames: by noise alone, the squared error is expected to be what it is.
TEST_F(Stopping, PredictedExcessIsThatOfTheFramesThatItIsMeasuredOn) {
  decide(GuideStage::kCamera, 2, 1.3);
  const StopAudit audit = cameraAudit();
  ASSERT_TRUE(audit.held_out_excess && audit.measured_excess);
  EXPECT_GT(*audit.held_out_excess, 0.002);
  // One draw of 22 parameters' errors, a few of which are most of it.
  EXPECT_NEAR(std::log(*audit.measured_excess / *audit.held_out_excess), 0, std::log(3));
}

TEST_F(Stopping, SoonAfterEnoughIsRight) {
  decide(GuideStage::kCamera, 2, 15);
  const auto enough = cameraAudit().enough;
  ASSERT_TRUE(enough);
  decisions_.clear();
  stopped_ = false;
  decide(GuideStage::kCamera, 2, secondsBetween(frames_.front().t, *enough) + 3);
  EXPECT_EQ(cameraAudit().verdict, Stop::kRight) << cameraAudit().explanation;
}

// Poses absorb what cameras of a few views are off by.
TEST_F(Stopping, HeldOutFramesAloneAreNoProof) {
  decide(GuideStage::kCamera, 2, 1.3);
  const StopAudit audit = cameraAudit();
  ASSERT_TRUE(audit.measured_excess && audit.measured_px && audit.reference_std_px);
  EXPECT_LT(*audit.measured_excess, 0.05);
  EXPECT_GT(*audit.measured_px, 0.3);
  EXPECT_LT(*audit.reference_std_px, 0.1);
  EXPECT_EQ(audit.verdict, Stop::kEarly) << audit.explanation;
  EXPECT_TRUE(audit.all_suffice.value_or(false));
}

// An accuracy that the whole recording does not have is not agreed upon by two parts of it.
TEST_F(Stopping, BelowTheDeviationOfAllFramesNothingIsSufficient) {
  decide(GuideStage::kCamera, 1, 19);
  StoppingRuleOptions strict;
  strict.projection_px = 0.01;
  const ReplayRun r = run();
  const StopAudit audit = judgeCameraStop(r, cameraBatches(r, keptCameras(r)), strict);
  EXPECT_EQ(audit.verdict, Stop::kEarly);
  EXPECT_FALSE(audit.enough.has_value());
  EXPECT_FALSE(audit.all_suffice.value_or(true));
  EXPECT_THAT(audit.explanation, HasSubstr("exceed the bars"));
}

// What comes after its end would have been sufficient: nothing was late.
TEST_F(Stopping, AStageThatWasEndedTooEarlyIsNotLate) {
  decide(GuideStage::kCamera, 2, 1.3);
  ReplayRun r = run();
  r.camera_end = CameraStageEnd::kHalf;
  const StopAudit audit = judgeCameraStop(r, cameraBatches(r, keptCameras(r)));
  EXPECT_EQ(audit.verdict, Stop::kNeverStopped);
  EXPECT_EQ(audit.seconds, 0);
  EXPECT_THAT(audit.explanation, Not(HasSubstr("late by")));
}

// By the measure that the stage stopped by, and not by what held-out frames say.
TEST_F(Stopping, ACameraStageThatStopsByProjectionsIsJudgedByThem) {
  decide(GuideStage::kCamera, 2, 10);
  decisions_.back().projection_px = 0.4;
  ReplayRun r = run();
  const auto judged = [&](double bar_px) {
    r.guide.views.stop_projection_px = bar_px;
    return judgeCameraStop(r, cameraBatches(r, keptCameras(r)));
  };
  EXPECT_EQ(judged(10).verdict, Stop::kLate) << judged(10).explanation;
  EXPECT_EQ(judged(1e-3).verdict, Stop::kEarly) << judged(1e-3).explanation;
  EXPECT_EQ(judged(10).predicted_px, 0.4);
  EXPECT_THAT(judged(10).explanation, HasSubstr("0.400 px expected by the guide"));
}

TEST_F(Stopping, ARecordingWithoutAStopSaysSo) {
  decide(GuideStage::kCamera, 4, 1e9);
  const StopAudit audit = cameraAudit();
  EXPECT_EQ(audit.verdict, Stop::kNeverStopped);
  EXPECT_FALSE(audit.finished.has_value());
  EXPECT_THAT(audit.explanation, HasSubstr("did not say stop"));
  ASSERT_TRUE(audit.enough);
  EXPECT_NEAR(audit.seconds, secondsBetween(*audit.enough, frames_.back().t), 1e-9);
  EXPECT_THAT(audit.explanation, HasSubstr("late by"));
}

TEST_F(Stopping, WhatCannotBeSolvedIsNotJudged) {
  decide(GuideStage::kCameraImu, 1, 1.5);
  const StopAudit audit = imuAudit();
  EXPECT_EQ(audit.verdict, Stop::kNotJudged);
  EXPECT_THAT(audit.explanation, HasSubstr("pairs of consecutive frames"));
}

TEST_F(Stopping, BatchesThatDidNotConvergeAreNoReference) {
  decide(GuideStage::kCameraImu, 1, 2.5);
  ReplayRun r = run();
  r.camera_imu.max_iterations = 1;
  const auto& cameras = recording_.truth.cameras;
  const StopAudit audit = judgeCameraImuStop(r, cameras, cameraImuBatches(r, cameras));
  EXPECT_EQ(audit.verdict, Stop::kNotJudged);
  EXPECT_THAT(audit.explanation, HasSubstr("converge"));
}

TEST_F(Stopping, ACameraImuStageThatStopsAtOnceIsEarly) {
  decide(GuideStage::kCameraImu, 1, 2.5);
  const StopAudit audit = imuAudit();
  EXPECT_EQ(audit.verdict, Stop::kEarly) << audit.explanation;
  // By the time that it took from there until it was enough, not until the end.
  ASSERT_TRUE(audit.enough);
  EXPECT_GT(audit.seconds, 0);
  EXPECT_NEAR(audit.seconds, secondsBetween(*audit.finished, *audit.enough), 1e-9);
}

TEST_F(Stopping, OptionsOutOfRangeAreRefused) {
  StoppingRuleOptions options;
  options.checkpoints = 1;
  EXPECT_THROW(judgeCameraStop(run(), {}, options), InputError);
  EXPECT_THROW(judgeCameraImuStop(run(), {}, {}, options), InputError);
}

// All three must be near: what no two recordings can give in one of them is never enough.
TEST_F(Stopping, EachPartOfTheCameraImuResultCounts) {
  decide(GuideStage::kCameraImu, 1, 18);
  StoppingRuleOptions translation, rotation, offset;
  translation.translation_m = rotation.rotation_rad = offset.offset_s = 1e-15;
  for (StoppingRuleOptions options : {translation, rotation, offset}) {
    options.checkpoints = 2;  // the fewest and the most frames
    const StopAudit audit = imuAudit(options);
    EXPECT_EQ(audit.verdict, Stop::kEarly) << audit.explanation;
  }
}

TEST_F(Stopping, ACameraImuStageIsJudgedByItsDistanceFromAllFrames) {
  decide(GuideStage::kCameraImu, 1, 18);
  const StopAudit audit = imuAudit();
  EXPECT_NE(audit.verdict, Stop::kEarly) << audit.explanation;
  EXPECT_THAT(audit.explanation, HasSubstr("mm"));
}

TEST_F(Stopping, ACameraStageThatWasEndedDidNotStop) {
  decide(GuideStage::kCamera, 2, 10);
  ReplayRun r = run();
  r.camera_end = CameraStageEnd::kHalf;
  const StopAudit audit = judgeCameraStop(r, cameraBatches(r, keptCameras(r)));
  EXPECT_EQ(audit.verdict, Stop::kNeverStopped);
  EXPECT_FALSE(audit.finished.has_value());
  ASSERT_TRUE(audit.ended.has_value());
  EXPECT_THAT(audit.explanation, HasSubstr("ended at half of it, 10.0 s"));
  EXPECT_GE(audit.seconds, 0);
  // A wrong stamp of the first frame does not count.
  r.since = frames_[10].t;
  EXPECT_THAT(judgeCameraStop(r, cameraBatches(r, keptCameras(r))).explanation,
              HasSubstr("ended at half of it, 9.0 s"));
}

TEST_F(Stopping, ACameraImuStageThatStopsByPointsIsJudgedByThem) {
  decide(GuideStage::kCameraImu, 1, 18);
  decisions_.back().error_px = 0.25;
  ReplayRun r = run();
  const auto& cameras = recording_.truth.cameras;
  const auto judged = [&](double bar_px) {
    r.guide.trajectories.stop_reprojection_px = bar_px;
    return judgeCameraImuStop(r, cameras, cameraImuBatches(r, cameras));
  };
  const StopAudit loose = judged(100), strict = judged(1e-9);
  EXPECT_EQ(loose.predicted_px, 0.25);
  EXPECT_EQ(loose.verdict, Stop::kLate) << loose.explanation;
  EXPECT_EQ(strict.verdict, Stop::kEarly) << strict.explanation;
  // The last second of twenty changes the points by less than a pixel, but by something.
  ASSERT_TRUE(loose.measured_px);
  EXPECT_GT(*loose.measured_px, 0);
  EXPECT_LT(*loose.measured_px, 1);
  EXPECT_THAT(loose.explanation, HasSubstr("0.250 px expected by the guide"));
}

}  // namespace
}  // namespace plumbline
