// SPDX-License-Identifier: BSD-3-Clause
// What the camera-IMU stage does with recordings that lack something: it says what and at which
// frame, and goes on. Those that take whole recordings are in
// camera_imu_guide_input_statistics_test.cpp.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/guidance/guide.h"
#include "calibrator/guidance/imu_stage_recording.h"
#include "tests/calibrator/guidance/imu_guide_input.h"

namespace plumbline {
namespace {

using test::imu_input::count;
using test::imu_input::expectItWentOn;
using test::imu_input::frames;
using test::imu_input::framesWithout;
using test::imu_input::inputRecording;
using test::imu_input::keptBy;
using test::imu_input::Replay;
using test::imu_input::replayed;
using ::testing::HasSubstr;

TEST(CameraImuGuideInput, WithoutImuNothingBegins) {
  auto without = frames();
  for (GuideFrame& frame : without) frame.imu.clear();
  const Replay r = replayed(without);
  EXPECT_EQ(count(r.decisions, GuideReason::kNoImu), 160);
  EXPECT_THAT(r.decisions[5].detail, HasSubstr("no IMU sample has arrived"));
  EXPECT_FALSE(r.guide.finished());
  EXPECT_FALSE(r.guide.batch());
}

TEST(CameraImuGuideInput, ASensorAtRestIsNotEnoughToStart) {
  SimulationOptions still;
  still.duration_s = 3;
  still.trajectory.kind = MotionKind::kStatic;
  const SimulatedSession s = simulateSession(simulatedRig("euroc"), still);
  const Replay r = replayed(test::framesOf(s.session));
  EXPECT_GT(count(r.decisions, GuideReason::kInitialiseFailed), 2);
  EXPECT_EQ(count(r.decisions, GuideReason::kInitialised), 0);
  const Decision* failed = test::firstWith(r.decisions, GuideReason::kInitialiseFailed);
  EXPECT_TRUE(failed->failure);
  EXPECT_TRUE(failed->accepted);  // kept for the next try
  EXPECT_EQ(r.decisions.back().mode, GuideMode::kInitialising);
}

TEST(CameraImuGuideInput, ARecordingTooShortToStartSaysSo) {
  auto few = frames();
  few.resize(12);
  const Replay r = replayed(few);
  EXPECT_EQ(count(r.decisions, GuideReason::kInitialising), 12);
  EXPECT_FALSE(r.guide.batch());
}

// Samples of 0.4 s are missing: frames in between have no IMU, the first one after is joined by the
// biases' walk and waits for the one that follows it.
TEST(CameraImuGuideInput, AnImuGapInTheWindow) {
  auto broken = frames();
  broken.resize(130);
  const TimeNs from = broken[80].t;
  const TimeNs to = from + 400'000'000;
  for (GuideFrame& frame : broken) {
    std::erase_if(frame.imu, [&](const ImuSample& s) { return s.t > from && s.t < to; });
  }
  const Replay r = replayed(broken);
  EXPECT_EQ(r.decisions[79].reason, GuideReason::kUsed);
  for (std::size_t i = 82; i < 87; ++i) {
    EXPECT_EQ(r.decisions[i].reason, GuideReason::kNoImu) << i;
    EXPECT_FALSE(r.decisions[i].accepted);
    EXPECT_THAT(r.decisions[i].detail, HasSubstr("the last IMU sample is 0."));
  }
  const Decision* gap = test::firstWith(r.decisions, GuideReason::kImuGap);
  ASSERT_TRUE(gap);
  EXPECT_THAT(gap->frame, ::testing::AllOf(::testing::Ge(87), ::testing::Le(89)));
  EXPECT_THAT(gap->detail, HasSubstr("IMU samples pause for 0.4"));
  EXPECT_THAT(gap->detail, HasSubstr("random walk of the biases"));
  EXPECT_EQ(count(r.decisions, GuideReason::kNotSolved), 0);
  expectItWentOn(r, 92);
}

TEST(CameraImuGuideInput, CornersThatFitNoPoseAreLeftOut) {
  auto wrong = frames();
  wrong.resize(120);
  for (auto& corners : wrong[70].corners) {
    for (std::size_t k = 0; k < corners.size(); ++k) {
      corners[k].uv = Eigen::Vector2d(40.0 * ((7 * k) % 17), 25.0 * ((5 * k) % 19));
    }
  }
  const Replay r = replayed(wrong);
  EXPECT_EQ(r.decisions[70].reason, GuideReason::kNoPose);
  expectItWentOn(r, 72);
}

TEST(CameraImuGuideInput, OptionsOutOfRangeAreRefused) {
  GuideOptions options;
  options.trajectories.window = 1;
  EXPECT_THROW(
      CameraImuGuide(test::rigOf(inputRecording()), inputRecording().truth.cameras, options),
      InputError);
  const AprilGrid& target = inputRecording().session.target;
  EXPECT_THROW(poseFrame(frames().front(), target, inputRecording().truth.cameras, 3, 30),
               InputError);
  EXPECT_THROW(poseFrame(frames().front(), target, inputRecording().truth.cameras, 16, 0),
               InputError);
}

TEST(CameraImuGuideInput, ATargetThatNeverCameIntoViewIsSaid) {
  auto never = frames();
  for (GuideFrame& frame : never) {
    for (auto& corners : frame.corners) corners.clear();
  }
  const Replay r = replayed(never);
  EXPECT_EQ(std::count_if(r.decisions.begin(), r.decisions.end(),
                          [](const Decision& d) { return !d.detail.empty(); }),
            1);
  EXPECT_THAT(r.decisions[41].detail, HasSubstr("out of view for 2.050 s"));
}

// One frame alone between two pauses: no link tells its velocity, so it is not part of the
// estimate.
TEST(CameraImuGuideInput, AFrameBetweenTwoPausesIsWithdrawn) {
  const auto paused = framesWithout(60, 110, 85);
  const Replay r = replayed(paused);
  EXPECT_TRUE(r.decisions[85].accepted);
  EXPECT_THAT(r.decisions[85].detail, HasSubstr("waits for the next frame"));
  const auto with = std::find_if(r.decisions.begin(), r.decisions.end(),
                                 [](const Decision& d) { return !d.withdrawn.empty(); });
  ASSERT_NE(with, r.decisions.end());
  EXPECT_EQ(with->withdrawn, std::vector<int>{85});
  EXPECT_THAT(with->detail, HasSubstr("frame 85: "));
  EXPECT_EQ(keptBy(r.decisions), r.decisions.back().views_kept);
  expectItWentOn(r, 112);
}

TEST(CameraImuGuideInput, AFirstFrameStampedFarAheadIsWithdrawn) {
  auto ahead = frames();
  ahead.resize(40);
  ahead[0].t += 1'000'000'000'000;
  const Replay r = replayed(ahead);
  EXPECT_TRUE(r.decisions[0].accepted);
  EXPECT_EQ(r.decisions[1].reason, GuideReason::kTimeJump);
  EXPECT_TRUE(r.decisions[2].accepted);
  EXPECT_EQ(r.decisions[2].withdrawn, std::vector<int>{0});
  EXPECT_THAT(r.decisions[2].detail, HasSubstr("frame 0: its stamp is far from"));
  EXPECT_EQ(count(r.decisions, GuideReason::kInitialised), 1);
  EXPECT_EQ(keptBy(r.decisions), r.decisions.back().views_kept);
}

}  // namespace
}  // namespace plumbline
