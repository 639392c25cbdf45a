// SPDX-License-Identifier: BSD-3-Clause
// What the camera-IMU stage does with recordings that lack something: it says what and at which
// frame, and goes on.
#include <Eigen/Cholesky>
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/guidance/guide.h"
#include "calibrator/guidance/imu_stage_recording.h"
#include "tests/calibrator/guidance/imu_guide_replay.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

const SimulatedSession& inputRecording() {
  static const SimulatedSession s = [] {
    SimulationOptions options;
    options.duration_s = 8;
    options.seed = options.trajectory.seed = 1;
    return simulateSession(simulatedRig("euroc"), options);
  }();
  return s;
}

struct Replay {
  std::vector<Decision> decisions;
  CameraImuGuide guide;
};
Replay replayed(const std::vector<GuideFrame>& frames) {
  GuideOptions options;
  options.trajectories.pixel_sigma = 0.2;
  options.trajectories.cauchy_px = 0;
  options.trajectories.threshold_nats = 0;  // it goes on to the end
  Replay r{{}, {test::rigOf(inputRecording()), inputRecording().truth.cameras, options}};
  r.decisions = test::replay(r.guide, frames);
  return r;
}

std::vector<GuideFrame> frames() { return test::framesOf(inputRecording().session); }

/// Without the target from one frame to another, but in the one that is `seen`; -1: in none.
std::vector<GuideFrame> framesWithout(int from, int to, int seen = -1) {
  auto all = frames();
  for (int i = from; i < to; ++i) {
    if (i == seen) continue;
    for (auto& corners : all[static_cast<std::size_t>(i)].corners) corners.clear();
  }
  return all;
}

int count(const std::vector<Decision>& decisions, GuideReason reason) {
  return static_cast<int>(
      std::count_if(decisions.begin(), decisions.end(),
                    [reason](const Decision& d) { return d.reason == reason; }));
}

/// Frames accepted, less those withdrawn later.
int keptBy(const std::vector<Decision>& decisions) {
  int kept = 0;
  for (const Decision& d : decisions) {
    kept += (d.accepted ? 1 : 0) - static_cast<int>(d.withdrawn.size());
  }
  return kept;
}

/// Frames used well after the fault, and the truth within the batch's covariance.
void expectItWentOn(const Replay& r, std::size_t after) {
  int used = 0;
  for (std::size_t i = after; i < r.decisions.size(); ++i) {
    if (r.decisions[i].reason == GuideReason::kUsed) ++used;
    if (r.decisions[i].rmse_px) {
      EXPECT_LT(*r.decisions[i].rmse_px, 0.6);
    }
  }
  EXPECT_GT(used, static_cast<int>(r.decisions.size() - after) / 2);
  const auto result = r.guide.batch();
  ASSERT_TRUE(result) << result.failure();
  const Vector6d error = boxminus(inputRecording().truth.imu->T_SC0, result->imu.T_SC0);
  const Eigen::MatrixXd covariance = result->summary.covariance.matrix.topLeftCorner(6, 6);
  EXPECT_LT(error.dot(covariance.llt().solve(error)), 22.46);  // 6 dof, 99.9 %
}

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

TEST(CameraImuGuideInput, AJumpForwardInTime) {
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

TEST(CameraImuGuideInput, APauseOfTheFramesAlone) {
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

TEST(CameraImuGuideInput, StampsThatGoBackArePassedOver) {
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

TEST(CameraImuGuideInput, TheTargetIsLostForLong) {
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

TEST(CameraImuGuideInput, AFewCornersAreNoView) {
  auto few = frames();
  for (auto& corners : few[70].corners) corners.resize(8);
  const Replay r = replayed(few);
  EXPECT_EQ(r.decisions[70].reason, GuideReason::kNoTarget);
  EXPECT_EQ(r.decisions[71].reason, GuideReason::kUsed);
}

TEST(CameraImuGuideInput, CornersThatFitNoPoseAreLeftOut) {
  auto wrong = frames();
  for (auto& corners : wrong[70].corners) {
    for (std::size_t k = 0; k < corners.size(); ++k) {
      corners[k].uv = Eigen::Vector2d(40.0 * ((7 * k) % 17), 25.0 * ((5 * k) % 19));
    }
  }
  const Replay r = replayed(wrong);
  EXPECT_EQ(r.decisions[70].reason, GuideReason::kNoPose);
  expectItWentOn(r, 72);
}

// Samples that arrive with the frame after: frames wait for them, and none is lost.
TEST(CameraImuGuideInput, SamplesThatArriveLate) {
  const Replay late = replayed(test::framesOf(inputRecording().session, -0.001));
  EXPECT_EQ(count(late.decisions, GuideReason::kNoImu), 0);
  EXPECT_EQ(count(late.decisions, GuideReason::kImuGap), 0);
  expectItWentOn(late, 40);
}

// Samples stamped 0.3 s behind the camera's clock come with their frames all the same.
TEST(CameraImuGuideInput, ClocksThatDisagree) {
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
TEST(CameraImuGuideInput, AnImuThatStopsUnderAClockAhead) {
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
TEST(CameraImuGuideInput, SamplesThatComeLateByTheOffset) {
  Session session = inputRecording().session;
  for (ImuSample& s : session.imu->samples) s.t += 200'000'000;
  const Replay r = replayed(test::framesOf(session));
  EXPECT_EQ(count(r.decisions, GuideReason::kInitialised), 1);
  for (std::size_t i = 10; i < r.decisions.size(); ++i) {
    EXPECT_NE(r.decisions[i].reason, GuideReason::kNoImu) << i;
  }
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

// Some come with every frame, but ever older ones.
TEST(CameraImuGuideInput, SamplesThatFallEverFurtherBehind) {
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

// The same before the start, whose batch has no use for it.
TEST(CameraImuGuideInput, AFrameThatTheStartLeavesOutIsWithdrawn) {
  const auto paused = framesWithout(5, 55, 30);
  const Replay r = replayed(paused);
  EXPECT_TRUE(r.decisions[30].accepted);
  const Decision* start = test::firstWith(r.decisions, GuideReason::kInitialised);
  ASSERT_NE(start, nullptr);
  EXPECT_EQ(start->withdrawn, std::vector<int>{30});
  EXPECT_THAT(start->detail, HasSubstr("frame 30: not used by the start"));
  EXPECT_EQ(keptBy(r.decisions), r.decisions.back().views_kept);
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

// A frame after a pause has no pose by the window: the one after it is as far from the last frame
// that is in the window, however near the two are.
TEST(CameraImuGuideInput, TheFirstFrameAfterAPauseIsWrong) {
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
