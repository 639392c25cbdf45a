// SPDX-License-Identifier: BSD-3-Clause
// More of what the camera-IMU stage does with recordings that lack something, each played to its
// end: too long for sanitizers, under which camera_imu_guide_input_test.cpp runs.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/guidance/guide.h"
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

TEST(CameraImuGuideLongInput, AJumpForwardInTime) {
  auto jumped = frames();
  for (std::size_t i = 80; i < jumped.size(); ++i) {
    jumped[i].t += 3'000'000'000;
    for (ImuSample& s : jumped[i].imu) s.t += 3'000'000'000;
  }
  const Replay r = replayed(jumped);
  const Decision& d = r.decisions[80];
  EXPECT_THAT(d.reason, ::testing::AnyOf(GuideReason::kTimeJump, GuideReason::kImuGap));
  EXPECT_THAT(d.detail, HasSubstr("random walk of the biases"));
  EXPECT_EQ(count(r.decisions, GuideReason::kNotSolved), 0);
  expectItWentOn(r, 84);
}

TEST(CameraImuGuideLongInput, APauseOfTheFramesAlone) {
  auto paused = frames();
  std::vector<ImuSample> between;
  for (std::size_t i = 80; i < 105; ++i) {
    between.insert(between.end(), paused[i].imu.begin(), paused[i].imu.end());
  }
  paused.erase(paused.begin() + 80, paused.begin() + 105);
  paused[80].imu.insert(paused[80].imu.begin(), between.begin(), between.end());
  const Replay r = replayed(paused);
  EXPECT_EQ(r.decisions[80].reason, GuideReason::kTimeJump);
  EXPECT_TRUE(r.decisions[80].accepted);
  EXPECT_THAT(r.decisions[80].detail, HasSubstr("1.300 s after the last frame used"));
  EXPECT_EQ(count(r.decisions, GuideReason::kTimeJump), 1);
  expectItWentOn(r, 82);
}

TEST(CameraImuGuideLongInput, StampsThatGoBackArePassedOver) {
  auto back = frames();
  const std::vector<GuideFrame> again(back.begin() + 70, back.begin() + 80);
  back.insert(back.begin() + 80, again.begin(), again.end());
  const Replay r = replayed(back);
  EXPECT_EQ(count(r.decisions, GuideReason::kTimeJump), 10);
  for (std::size_t i = 80; i < 90; ++i) {
    EXPECT_EQ(r.decisions[i].reason, GuideReason::kTimeJump);
    EXPECT_FALSE(r.decisions[i].accepted);
  }
  EXPECT_THAT(r.decisions[80].detail, HasSubstr("0.450000 s before"));
  EXPECT_EQ(r.decisions[90].reason, GuideReason::kUsed);
  expectItWentOn(r, 90);
}

TEST(CameraImuGuideLongInput, TheTargetIsLostForLong) {
  const auto lost = framesWithout(60, 110);
  const Replay r = replayed(lost);
  EXPECT_EQ(count(r.decisions, GuideReason::kNoTarget), 50);
  EXPECT_TRUE(r.decisions[90].detail.empty());
  const Decision* said = nullptr;  // once
  for (std::size_t i = 60; i < 110; ++i) {
    if (r.decisions[i].detail.empty()) continue;
    EXPECT_FALSE(said) << i;
    said = &r.decisions[i];
    EXPECT_THAT(said->detail, HasSubstr("out of view for 2.050 s"));
  }
  EXPECT_TRUE(said);
  EXPECT_THAT(r.decisions[110].detail, HasSubstr("back after 2.550 s"));
  EXPECT_EQ(r.decisions[110].reason, GuideReason::kUsed);
  EXPECT_THAT(r.decisions[110].detail, HasSubstr("random walk of the biases"));
  expectItWentOn(r, 112);
}

TEST(CameraImuGuideLongInput, AFewCornersAreNoView) {
  auto few = frames();
  for (auto& corners : few[70].corners) corners.resize(8);
  const Replay r = replayed(few);
  EXPECT_EQ(r.decisions[70].reason, GuideReason::kNoTarget);
  EXPECT_EQ(r.decisions[71].reason, GuideReason::kUsed);
}

// Samples that arrive with the frame after: frames wait for them, and none is lost.
TEST(CameraImuGuideLongInput, SamplesThatArriveLate) {
  const Replay late = replayed(test::framesOf(inputRecording().session, -0.001));
  EXPECT_EQ(count(late.decisions, GuideReason::kNoImu), 0);
  EXPECT_EQ(count(late.decisions, GuideReason::kImuGap), 0);
  expectItWentOn(late, 40);
}

// Samples stamped 0.3 s behind the camera's clock come with their frames all the same.
TEST(CameraImuGuideLongInput, ClocksThatDisagree) {
  auto behind = frames();
  for (GuideFrame& frame : behind) {
    for (ImuSample& s : frame.imu) s.t -= 300'000'000;
  }
  const Replay r = replayed(behind);
  EXPECT_EQ(count(r.decisions, GuideReason::kNoImu), 0);
  EXPECT_EQ(count(r.decisions, GuideReason::kInitialised), 1);
  expectItWentOn(r, 60);
}

// Samples stamped 0.3 s ahead of the camera's clock: that the IMU stops is noticed all the same,
// with the second frame that it does not reach.
TEST(CameraImuGuideLongInput, AnImuThatStopsUnderAClockAhead) {
  auto ahead = frames();
  for (GuideFrame& frame : ahead) {
    if (frame.index > 100) frame.imu.clear();
    for (ImuSample& s : frame.imu) s.t += 300'000'000;
  }
  const Replay r = replayed(ahead);
  EXPECT_EQ(count(r.decisions, GuideReason::kInitialised), 1);
  EXPECT_EQ(r.decisions[100].reason, GuideReason::kUsed);
  for (std::size_t i = 102; i < 106; ++i) {
    EXPECT_EQ(r.decisions[i].reason, GuideReason::kNoImu) << i;
  }
}

// As a recording is played by its stamps: each frame comes 0.15 s before its samples.
TEST(CameraImuGuideLongInput, SamplesThatComeLateByTheOffset) {
  Session session = inputRecording().session;
  for (ImuSample& s : session.imu->samples) s.t += 200'000'000;
  const Replay r = replayed(test::framesOf(session));
  EXPECT_EQ(count(r.decisions, GuideReason::kInitialised), 1);
  for (std::size_t i = 10; i < r.decisions.size(); ++i) {
    EXPECT_NE(r.decisions[i].reason, GuideReason::kNoImu) << i;
  }
}

// Some come with every frame, but ever older ones.
TEST(CameraImuGuideLongInput, SamplesThatFallEverFurtherBehind) {
  auto slow = frames();
  std::vector<ImuSample> waiting;
  for (std::size_t i = 60; i < slow.size(); ++i) {
    waiting.insert(waiting.end(), slow[i].imu.begin(), slow[i].imu.end());
    slow[i].imu.assign(waiting.begin(),
                       waiting.begin() + std::min<std::ptrdiff_t>(3, std::ssize(waiting)));
    waiting.erase(waiting.begin(), waiting.begin() + std::ssize(slow[i].imu));
  }
  const Replay r = replayed(slow);
  EXPECT_EQ(count(r.decisions, GuideReason::kInitialised), 1);
  EXPECT_GT(count(r.decisions, GuideReason::kNoImu), 20);
}

// The same before the start, whose batch has no use for it.
TEST(CameraImuGuideLongInput, AFrameThatTheStartLeavesOutIsWithdrawn) {
  const auto paused = framesWithout(5, 55, 30);
  const Replay r = replayed(paused);
  EXPECT_TRUE(r.decisions[30].accepted);
  const Decision* start = test::firstWith(r.decisions, GuideReason::kInitialised);
  ASSERT_NE(start, nullptr);
  EXPECT_EQ(start->withdrawn, std::vector<int>{30});
  EXPECT_THAT(start->detail, HasSubstr("frame 30: not used by the start"));
  EXPECT_EQ(keptBy(r.decisions), r.decisions.back().views_kept);
}

// A frame after a pause has no pose by the window: the one after it is as far from the last frame
// that is in the window, however near the two are.
TEST(CameraImuGuideLongInput, TheFirstFrameAfterAPauseIsWrong) {
  auto paused = framesWithout(60, 90);
  // Consistent with a pose, but not with the IMU's motion to the next frame.
  paused[90].corners = paused[40].corners;
  const Replay r = replayed(paused);
  EXPECT_TRUE(r.decisions[90].accepted);
  EXPECT_THAT(r.decisions[90].detail, HasSubstr("random walk of the biases"));
  expectItWentOn(r, 96);
}

}  // namespace
}  // namespace plumbline
