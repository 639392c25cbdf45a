// SPDX-License-Identifier: BSD-3-Clause
// A stage in figures, for decisions made up on a simulated recording.
#include "evaluate/replay/stage_summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/evaluate/replay/decided_recording.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;

/// 60 frames; the camera stage accepts every third and finishes with frame 44.
class Summary : public DecidedRecording {
 protected:
  Summary() : DecidedRecording(12, 5) {}

  void SetUp() override {
    for (const GuideFrame& frame : frames_) {
      Decision d;
      d.t = frame.t;
      d.frame = frame.index;
      d.accepted = frame.index % 3 == 0 && frame.index < 45;
      d.reason = frame.index > 44 ? GuideReason::kFinished : GuideReason::kInformative;
      d.mode = frame.index < 44 ? GuideMode::kCollecting : GuideMode::kFinished;
      decisions_.push_back(d);
    }
  }

  ReplayStageSummary summary() const {
    const ReplayRun r = run();
    return summariseCameraStage(r, cameraBatches(r, keptCameras(r)));
  }
};

TEST_F(Summary, AWithdrawnFrameWasNotKept) {
  decisions_[12].withdrawn = {3, 9};
  const std::vector<int> kept = run().accepted(GuideStage::kCamera);
  EXPECT_THAT(kept, ElementsAre(0, 6, 12, 15, 18, 21, 24, 27, 30, 33, 36, 39, 42));
  EXPECT_TRUE(run().accepted(GuideStage::kCameraImu).empty());
}

TEST_F(Summary, IsThatOfAStageWhichNeverTookWhatItWithdrew) {
  const ReplayStageSummary all = summary();
  decisions_[12].withdrawn = {3, 9};
  const ReplayStageSummary withdrawn = summary();
  decisions_[12].withdrawn.clear();
  decisions_[3].accepted = decisions_[9].accepted = false;
  const ReplayStageSummary never = summary();
  ASSERT_TRUE(withdrawn.kept_batch && never.kept_batch && all.kept_batch);
  EXPECT_EQ(all.views_used, 15);
  EXPECT_EQ(withdrawn.views_used, 13);
  EXPECT_EQ(withdrawn.kept_batch->entropy_nats, never.kept_batch->entropy_nats);
  EXPECT_EQ(withdrawn.views_redundant, never.views_redundant);
  EXPECT_EQ(withdrawn.views_missed, never.views_missed);
  EXPECT_EQ(withdrawn.information_after_finish_nats, never.information_after_finish_nats);
  EXPECT_GT(withdrawn.information_after_finish_nats, all.information_after_finish_nats);
}

TEST_F(Summary, BothBatchesAreUnderTheRunsOptions) {
  for (Decision& d : decisions_) d.accepted = true;
  ReplayRun r = run();
  const auto guides_own = calibrateCameras(r.sessionFrom());
  r.camera.frames.min_corners = 110;
  r.camera.filter = CornerFilter::kSigma;
  r.camera.filter_sigmas = 2;
  const auto batches = cameraBatches(r, guides_own);
  ASSERT_TRUE(batches.kept && batches.full) << batches.problem;
  const StageSummary& kept = batches.kept->summary;
  EXPECT_LT(kept.corners_used, guides_own->summary.corners_used);
  EXPECT_LT(kept.views_used, guides_own->summary.views_used);
  EXPECT_EQ(kept.corners_used, batches.full->summary.corners_used);
  EXPECT_EQ(kept.views_used, batches.full->summary.views_used);
  EXPECT_NEAR(kept.entropy_nats, batches.full->summary.entropy_nats, 1e-4);
}

TEST_F(Summary, ABatchThatTheGuideCouldNotSolveIsTriedFromTheViewsAlone) {
  const ReplayRun r = run();
  const auto batches = cameraBatches(r, Failure{FailureCode::kCamerasNotConverged});
  EXPECT_TRUE(batches.kept.has_value()) << batches.problem;
}

TEST_F(Summary, AStageThatStartedAnewStartedThen) {
  decisions_[6].reason = decisions_[30].reason = GuideReason::kInitialised;
  decisions_[20].reason = GuideReason::kInitialiseFailed;
  decisions_[20].detail = "the stage restarts";
  decisions_[20].withdrawn = {0, 3, 6, 9, 12, 15, 18};
  const ReplayStageSummary anew = summariseCameraStage(run(), {});
  ASSERT_TRUE(anew.started.has_value());
  EXPECT_EQ(*anew.started, frames_[30].t);
  EXPECT_EQ(anew.views_used, 8);
  decisions_[30].reason = GuideReason::kNotInformative;
  const ReplayStageSummary never = summariseCameraStage(run(), {});
  EXPECT_FALSE(never.ran);
  EXPECT_EQ(never.problem, "frame 20: the stage restarts");
}

TEST_F(Summary, SaysWhatMostFramesWereRefusedFor) {
  for (Decision& d : decisions_) {
    d.accepted = false;
    d.reason = d.frame < 50 ? GuideReason::kNoPose : GuideReason::kInitialising;
  }
  EXPECT_THAT(summary().problem,
              ::testing::AllOf(::testing::HasSubstr("enough frames to start from; 50 of 60"),
                               ::testing::HasSubstr("give no plausible pose")));
  for (Decision& d : decisions_) d.reason = GuideReason::kInitialising;
  EXPECT_THAT(summary().problem, ::testing::EndsWith("enough frames to start from"));
}

TEST_F(Summary, SaysWhyNoFrameCameToTheCameraImuStage) {
  const auto problem = [&] { return summariseCameraImuStage(run(), {}).problem; };
  decisions_[44].detail = "the batch over the views kept failed: nothing moved";
  EXPECT_EQ(problem(),
            "the camera stage finished with frame 44, but gave no cameras: the batch over the "
            "views kept failed: nothing moved");
  decisions_.resize(45);
  EXPECT_EQ(problem(), "the camera stage finished with the recording's last frame");
  decisions_.resize(44);
  EXPECT_EQ(problem(), "the camera stage took the whole recording");
}

}  // namespace
}  // namespace plumbline
