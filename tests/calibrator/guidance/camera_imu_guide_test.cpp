// SPDX-License-Identifier: BSD-3-Clause
// The camera-IMU stage on simulated recordings: its end, its decisions and its suggestions. Bad
// input has a file of its own (camera_imu_guide_input_test.cpp). The trajectories' scores and the
// window have tests of their own.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/guidance/guide.h"
#include "calibrator/guidance/trajectories/lissajous.h"
#include "tests/calibrator/guidance/imu_guide_replay.h"

namespace plumbline {
namespace {

constexpr double kImuGuideSigma = 0.2;  // [px]

SimulatedSession simulated(double duration_s) {
  SimulationOptions options;
  options.duration_s = duration_s;
  options.corner_sigma_px = kImuGuideSigma;
  options.seed = options.trajectory.seed = 1;
  return simulateSession(simulatedRig("euroc"), options);
}

/// Shared by the tests, for simulation takes longer than the guide.
const SimulatedSession& imuGuideRecording() {
  static const SimulatedSession s = simulated(8);
  return s;
}

/// Squared error and the noise that was simulated; a threshold that 8 s of recording reach.
GuideOptions matched() {
  GuideOptions options;
  options.trajectories = TrajectoryGuideOptions::patient();
  options.trajectories.pixel_sigma = kImuGuideSigma;
  options.trajectories.cauchy_px = 0;
  options.trajectories.threshold_nats = 1.2;
  return options;
}

CameraImuGuide guideFor(const SimulatedSession& s, const GuideOptions& options) {
  return {test::rigOf(s), s.truth.cameras, options};
}

struct ImuReplay {
  std::vector<Decision> decisions;
  CameraImuGuide guide;
};
ImuReplay imuReplayed(const std::vector<GuideFrame>& imuFrames,
                      const GuideOptions& options = matched()) {
  ImuReplay r{{}, guideFor(imuGuideRecording(), options)};
  r.decisions = test::replay(r.guide, imuFrames);
  return r;
}
std::vector<GuideFrame> imuFrames() { return test::framesOf(imuGuideRecording().session); }

/// A threshold that is never reached: the guide goes on to the recording's end.
GuideOptions endless() {
  GuideOptions options = matched();
  options.trajectories.threshold_nats = 0;
  return options;
}

/// chi-square of T_SC0's error under the batch's own covariance, 6 degrees of freedom.
double squaredError(const Result<CameraImuStageResult>& result) {
  const Vector6d error = boxminus(imuGuideRecording().truth.imu->T_SC0, result->imu.T_SC0);
  const Eigen::MatrixXd covariance = result->summary.covariance.matrix.topLeftCorner(6, 6);
  return error.dot(covariance.llt().solve(error));
}
constexpr double kChi2_999 = 22.46;  // 6 degrees of freedom, 99.9 %

int countIn(const std::vector<Decision>& decisions, GuideReason reason) {
  return static_cast<int>(
      std::count_if(decisions.begin(), decisions.end(),
                    [reason](const Decision& d) { return d.reason == reason; }));
}

/// Every number of a decision that the stage fills, to the last bit.
std::string described(const Decision& d) {
  std::string out = fmt::format("{} {} {} {} {} {}", d.t, d.frame, toString(d.mode),
                                toString(d.reason), d.accepted, d.detail);
  const auto add = [&out](double value) { out += fmt::format(" {:a}", value); };
  for (const auto& value : {d.mi_nats, d.entropy_nats, d.rmse_px, d.distance_px}) {
    add(value.value_or(-1));
  }
  if (d.T_FC0) add(d.T_FC0->matrix().sum());
  if (d.round) {
    out += fmt::format(" {} {} {}", d.round->asked, d.round->answered, d.round->best);
    for (const double gain : d.round->mi_nats) add(gain);
  }
  if (d.opened) out += d.opened->candidate;
  return out + toString(d.event);
}

TEST(CameraImuGuide, FinishesWithAnExtrinsicCalibrationWithinItsCovariance) {
  const ImuReplay r = imuReplayed(imuFrames());
  ASSERT_TRUE(r.guide.finished());
  const auto result = r.guide.batch();
  ASSERT_TRUE(result) << result.failure();
  EXPECT_LT(squaredError(result), kChi2_999);
  EXPECT_LT(std::abs(result->imu.timeOffset() - imuGuideRecording().truth.imu->timeOffset()),
            4 * *result->imu.time_offset_std_s);
  EXPECT_LT(result->frames.size(), 120u);  // of those kept before the end, not of all 160
}

TEST(CameraImuGuide, LogsWhatDroveItsDecisions) {
  const ImuReplay r = imuReplayed(imuFrames());
  EXPECT_EQ(countIn(r.decisions, GuideReason::kInitialised), 1);
  std::optional<double> entropy;
  bool finished = false;
  for (const Decision& d : r.decisions) {
    EXPECT_EQ(d.stage, GuideStage::kCameraImu);
    EXPECT_EQ(d.threshold_nats, 1.2);
    EXPECT_EQ(d.reason == GuideReason::kFinished, finished);
    finished = d.mode == GuideMode::kFinished;
    if (d.reason != GuideReason::kUsed) continue;
    EXPECT_TRUE(d.accepted && d.T_FC0 && d.rmse_px && d.entropy_nats && d.mi_nats);
    EXPECT_LT(*d.rmse_px, 3 * kImuGuideSigma);
    EXPECT_GT(*d.mi_nats, -0.05);  // knowledge grows, but for the estimate moving
    if (entropy) {
      EXPECT_NEAR(*entropy - *d.entropy_nats, *d.mi_nats, 1e-12);
    }
    entropy = d.entropy_nats;
  }
  const auto last = std::find_if(r.decisions.begin(), r.decisions.end(),
                                 [](const Decision& d) { return d.mode == GuideMode::kFinished; });
  ASSERT_NE(last, r.decisions.end());
  ASSERT_TRUE(last->round);
  EXPECT_LT(last->round->mi_nats[static_cast<std::size_t>(last->round->best)], 1.2);
  EXPECT_EQ(last->round->names.size(), 6u);
}

TEST(CameraImuGuide, ThreadsDoNotChangeADecision) {
  std::vector<std::string> one;
  for (const int threads : {1, 2, 4}) {
    GuideOptions options = endless();
    options.threads = threads;
    options.latency.trajectories_s = 0.3;
    std::vector<std::string> log;
    for (const Decision& d : imuReplayed(imuFrames(), options).decisions)
      log.push_back(described(d));
    if (threads == 1) one = log;
    EXPECT_EQ(log, one) << threads;
  }
}

// The answer of the evaluator stands on the frame that asked and comes with the first frame at its
// time; the next one is asked for no sooner than the options say.
TEST(CameraImuGuide, TheEvaluatorsLatencyShiftsItsAnswers) {
  const ImuReplay at_once = imuReplayed(imuFrames(), endless());
  GuideOptions options = endless();
  options.latency.trajectories_s = 0.42;
  const ImuReplay late = imuReplayed(imuFrames(), options);
  TimeNs asked = 0;
  for (std::size_t i = 0; i < late.decisions.size(); ++i) {
    if (at_once.decisions[i].round) {
      EXPECT_EQ(at_once.decisions[i].round->answered, at_once.decisions[i].t);
    }
    const auto& round = late.decisions[i].round;
    if (!round) continue;
    EXPECT_EQ(round->answered, round->asked + 420'000'000);
    EXPECT_GE(late.decisions[i].t, round->answered);
    EXPECT_LT(late.decisions[i - 1].t, round->answered);
    EXPECT_GE(round->asked, asked + 1'000'000'000);
    asked = round->asked;
    // Same snapshot, same scores as when they were there at once.
    const Decision& then = at_once.decisions[i - 9];
    ASSERT_TRUE(then.round);
    EXPECT_EQ(then.t, round->asked);
    EXPECT_EQ(then.round->mi_nats, round->mi_nats);
  }
  EXPECT_GT(asked, 0);
}

TEST(CameraImuGuide, FramesThatComeWhileItIsBusyAreDroppedButTheirSamplesAreNot) {
  GuideOptions options = endless();
  options.latency.imu_frame_s = 0.06;  // more than a frame's interval, less than two
  const ImuReplay r = imuReplayed(imuFrames(), options);
  EXPECT_EQ(countIn(r.decisions, GuideReason::kBusy), 80);
  EXPECT_EQ(countIn(r.decisions, GuideReason::kImuGap), 0);
  EXPECT_GT(countIn(r.decisions, GuideReason::kUsed), 30);
  for (const Decision& d : r.decisions) {
    if (d.reason != GuideReason::kBusy) continue;
    EXPECT_FALSE(d.accepted || d.entropy_nats || d.round);
  }
}

TEST(CameraImuGuide, ASuggestionIsOpenedReachedAndLeftAloneForItsDuration) {
  GuideOptions options = endless();
  options.trajectories.reached_px = 1e6;  // wherever the camera is
  options.trajectories.duration_s = 4;
  options.trajectories.max_speed_m_s = 5;
  CameraImuGuide guide(test::rigOf(imuGuideRecording()), imuGuideRecording().truth.cameras, options,
                       {.first_suggestion = 7});
  const auto decisions = test::replay(guide, imuFrames());
  std::optional<TimeNs> opened;
  std::optional<TimeNs> reached;
  int next = 7;
  for (const Decision& d : decisions) {
    if (d.event == SuggestionEvent::kOpened) {
      ASSERT_TRUE(d.opened);
      EXPECT_EQ(d.opened->id, next++);
      EXPECT_EQ(d.opened->path.size(), 60u);
      EXPECT_LT(boxminus(d.opened->path.front(), d.opened->T_FC0).norm(), 1e-12);
      EXPECT_EQ(d.opened->duration_s, 4);
      EXPECT_EQ(d.mode, GuideMode::kSuggesting);
      if (reached) {
        EXPECT_GE(d.t - *reached, 4'000'000'000);
        EXPECT_LE(d.t - *reached, 4'100'000'000) << "not the evaluator's next interval";
      }
      if (!opened) opened = d.t;
    }
    if (d.event == SuggestionEvent::kReached && !reached) {
      EXPECT_GE(d.held_s, 1);
      EXPECT_GE(d.t - *opened, 1'000'000'000);
      EXPECT_LE(d.t - *opened, 1'200'000'000);
      reached = d.t;
    }
  }
  EXPECT_TRUE(reached);
  EXPECT_EQ(guide.nextSuggestion(), next);
  EXPECT_EQ(next, 9);  // one after the start, one four seconds after it was reached
}

// Nobody stands still while the estimate starts: what is asked for first needs no scores.
TEST(CameraImuGuide, AsksForTheFirstTrajectoryAtOnce) {
  GuideOptions options = endless();
  options.trajectories.first = FirstTrajectory::kAtOnce;
  const ImuReplay r = imuReplayed(imuFrames(), options);
  const Decision& first = r.decisions.front();
  ASSERT_TRUE(first.opened);
  EXPECT_EQ(first.event, SuggestionEvent::kOpened);
  EXPECT_EQ(first.mode, GuideMode::kInitialising);
  EXPECT_EQ(first.opened->candidate, lissajousFirst().name);
  EXPECT_EQ(first.opened->mi_nats, 0) << "not scored";
  EXPECT_FALSE(first.opened->error_px);
  EXPECT_EQ(first.opened->path.size(), 60u);
  EXPECT_GE(*first.opened->duration_s, 5);
  // It stays open, and is the only one, until it has expired.
  for (const Decision& d : r.decisions) {
    if (d.frame > 0 && d.t - first.t <= toNanoseconds(10)) {
      EXPECT_FALSE(d.opened) << d.frame;
    }
  }
  EXPECT_EQ(countIn(r.decisions, GuideReason::kInitialised), 1);
}

TEST(CameraImuGuide, AScoredFirstTrajectoryComesAfterTheStart) {
  const ImuReplay r = imuReplayed(imuFrames(), endless());
  bool started = false, opened = false;
  for (const Decision& d : r.decisions) {
    started = started || d.reason == GuideReason::kInitialised;
    if (!d.opened) continue;
    EXPECT_TRUE(started);
    EXPECT_GT(d.opened->mi_nats, 0);
    opened = true;
  }
  EXPECT_TRUE(opened);
}

// The first one is reached while the estimate has not started: nothing else is asked for during it,
// and the scores of the next one are there when it ends.
TEST(CameraImuGuide, TheSecondTrajectoryFollowsTheFirst) {
  GuideOptions options = endless();
  options.trajectories.first = FirstTrajectory::kAtOnce;
  options.trajectories.reached_px = 1e6;
  options.trajectories.reached_s = 0.1;
  options.trajectories.duration_s = 3;
  options.trajectories.max_speed_m_s = 5;
  const ImuReplay r = imuReplayed(imuFrames(), options);
  std::vector<TimeNs> opened;
  std::optional<TimeNs> reached;
  for (const Decision& d : r.decisions) {
    if (d.event == SuggestionEvent::kReached && !reached) {
      reached = d.t;
      EXPECT_EQ(d.mode, GuideMode::kInitialising);
    }
    if (d.opened) opened.push_back(d.t);
  }
  ASSERT_TRUE(reached);
  ASSERT_GE(opened.size(), 2u);
  EXPECT_GE(opened[1] - *reached, 3'000'000'000);
  EXPECT_LE(opened[1] - *reached, 3'100'000'000);
}

TEST(CameraImuGuide, ASuggestionThatNobodyFollowsExpires) {
  GuideOptions options = endless();
  options.trajectories.expires_s = 2;
  options.trajectories.reached_px = 0.1;
  int expired = 0;
  for (const Decision& d : imuReplayed(imuFrames(), options).decisions) {
    if (d.event == SuggestionEvent::kReached) ADD_FAILURE();
    if (d.event != SuggestionEvent::kExpired) continue;
    ++expired;
    EXPECT_TRUE(d.suggestion);
    EXPECT_EQ(d.mode, GuideMode::kCollecting);
  }
  EXPECT_GE(expired, 2);
}

TEST(CameraImuGuide, ASuggestionThatIsOpenAtTheEndIsWithdrawn) {
  GuideOptions options = endless();
  options.trajectories.threshold_nats = 1.2;
  options.trajectories.reached_px = 0.1;
  const ImuReplay r = imuReplayed(imuFrames(), options);
  const auto last = std::find_if(r.decisions.begin(), r.decisions.end(),
                                 [](const Decision& d) { return d.mode == GuideMode::kFinished; });
  ASSERT_NE(last, r.decisions.end());
  ASSERT_NE(last, r.decisions.begin());
  ASSERT_EQ((last - 1)->mode, GuideMode::kSuggesting);
  EXPECT_EQ(last->event, SuggestionEvent::kWithdrawn);
  EXPECT_EQ(last->suggestion, (last - 1)->suggestion);
  EXPECT_FALSE((last + 1)->suggestion);
}

TEST(CameraImuGuide, WhatWasHeldIsNotHeldOverAPause) {
  GuideOptions options = endless();
  options.trajectories.reached_px = 1e6;  // wherever the camera is
  options.trajectories.reached_s = 1.4;
  auto paused = imuFrames();
  const ImuReplay whole = imuReplayed(paused, options);
  const auto opened = std::find_if(whole.decisions.begin(), whole.decisions.end(),
                                   [](const Decision& d) { return d.opened.has_value(); });
  ASSERT_NE(opened, whole.decisions.end());
  // 1.2 s of frames are missing while it is near.
  const auto at = static_cast<std::ptrdiff_t>(opened - whole.decisions.begin()) + 5;
  for (auto frame = paused.begin() + at; frame != paused.begin() + at + 24; ++frame) {
    auto& next = (paused.begin() + at + 24)->imu;
    next.insert(frame == paused.begin() + at ? next.begin() : next.end(), frame->imu.begin(),
                frame->imu.end());
  }
  paused.erase(paused.begin() + at, paused.begin() + at + 24);
  const ImuReplay r = imuReplayed(paused, options);
  const auto reached = std::find_if(r.decisions.begin(), r.decisions.end(), [](const Decision& d) {
    return d.event == SuggestionEvent::kReached;
  });
  ASSERT_NE(reached, r.decisions.end());
  const TimeNs back = paused[static_cast<std::size_t>(at)].t;
  EXPECT_GE(reached->t, back + 1'400'000'000);
}

// What a stage before is still busy with: frames are dropped, their samples are not.
TEST(CameraImuGuide, BeginsWhenTheStageBeforeIsDone) {
  const auto all = imuFrames();
  const TimeNs busy_until = all[30].t;
  CameraImuGuide guide(test::rigOf(imuGuideRecording()), imuGuideRecording().truth.cameras,
                       endless(), {0, busy_until});
  const auto decisions = test::replay(guide, all);
  for (std::size_t i = 0; i < 30; ++i) EXPECT_EQ(decisions[i].reason, GuideReason::kBusy);
  EXPECT_EQ(decisions[30].reason, GuideReason::kInitialising);
  EXPECT_EQ(countIn(decisions, GuideReason::kNoImu), 0);
}

}  // namespace
}  // namespace plumbline
