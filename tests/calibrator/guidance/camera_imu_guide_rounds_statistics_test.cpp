// SPDX-License-Identifier: BSD-3-Clause
// When the camera-IMU stage asks for trajectories and takes the evaluator's answers, over whole
// recordings: too long for sanitizers, under which camera_imu_guide_test.cpp runs.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calibrator/guidance/guide.h"
#include "calibrator/guidance/trajectories/lissajous.h"
#include "tests/calibrator/guidance/imu_guide_flight.h"

namespace plumbline {
namespace {

using test::imu_flight::countIn;
using test::imu_flight::endless;
using test::imu_flight::imuFrames;
using test::imu_flight::imuGuideRecording;
using test::imu_flight::ImuReplay;
using test::imu_flight::imuReplayed;

/// Shared: what it decides where answers come at once.
const ImuReplay& endlessReplay() {
  static const ImuReplay r = imuReplayed(imuFrames(), endless());
  return r;
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

TEST(CameraImuGuideRounds, ThreadsDoNotChangeADecision) {
  std::vector<std::string> one;
  for (const int threads : {1, 4}) {
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
TEST(CameraImuGuideRounds, TheEvaluatorsLatencyShiftsItsAnswers) {
  const ImuReplay& at_once = endlessReplay();
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

// Nobody stands still while the estimate starts: what is asked for first needs no scores.
TEST(CameraImuGuideRounds, AsksForTheFirstTrajectoryAtOnce) {
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
  // From where the operator is to the end of the curve, no faster than the limits.
  const auto& path = first.opened->path;
  ASSERT_TRUE(first.T_FC0);
  EXPECT_LT(boxminus(path.front(), *first.T_FC0).norm(), 1e-9);
  const LissajousTrajectory curve(lissajousFirst(), AprilGrid{}, Transform(), options.trajectories);
  EXPECT_LT(boxminus(path.back(), curve.cameraAt(curve.durationS()).T_FB).norm(), 1e-9);
  const double step_s = *first.opened->duration_s / static_cast<double>(path.size() - 1);
  const double approach_s = *first.opened->duration_s - curve.durationS();
  EXPECT_GT(approach_s, 0.1);
  for (std::size_t k = 1; k < path.size(); ++k) {
    const Vector6d step = boxminus(path[k], path[k - 1]);
    // Half of them on the way to the curve.
    const double share = static_cast<double>(k) * step_s <= approach_s ? 0.505 : 1.01;
    EXPECT_LE(step.head<3>().norm() / step_s, share * options.trajectories.max_speed_m_s) << k;
    EXPECT_LE(step.tail<3>().norm() / step_s, share * options.trajectories.max_rate_rad_s) << k;
  }
  // It begins where the rig is, however long others are held; and it is the only one until it ends.
  EXPECT_EQ(r.decisions[1].event, SuggestionEvent::kReached);
  for (const Decision& d : r.decisions) {
    if (d.frame > 0 && secondsBetween(first.t, d.t) <= *first.opened->duration_s) {
      EXPECT_FALSE(d.opened) << d.frame;
    }
  }
  EXPECT_EQ(countIn(r.decisions, GuideReason::kInitialised), 1);
}

// So far away that tags seen aslant are too small: nobody could follow the diagonal, and of the
// others only those are asked for that stay in view.
TEST(CameraImuGuideRounds, AsksForNoTrajectoryAlongWhichTheTargetIsLost) {
  GuideOptions options = endless();
  options.trajectories.first = FirstTrajectory::kAtOnce;
  options.trajectories.distance_ratio = 6;
  options.trajectories.amplitude = 7;
  const ImuReplay r = imuReplayed(imuFrames(), options);
  EXPECT_FALSE(r.decisions.front().opened);
  int asked = 0, lost = 0;
  for (const Decision& d : r.decisions) {
    if (!d.round) continue;
    for (const double mi : d.round->mi_nats) lost += std::isnan(mi) ? 1 : 0;
    if (!d.opened) continue;
    ++asked;
    EXPECT_GT(d.opened->mi_nats, 0);
    for (const Transform& T_FC0 : d.opened->path) {
      std::size_t most = 0;
      for (const CameraCalibration& c : imuGuideRecording().truth.cameras) {
        most = std::max(most, visibleCorners(c.intrinsics, T_FC0 * c.T_C0Ci, {}).size());
      }
      EXPECT_GE(most, 16u) << d.opened->candidate;
    }
  }
  EXPECT_GT(asked, 0);
  EXPECT_GT(lost, 0);
}

TEST(CameraImuGuideRounds, AScoredFirstTrajectoryComesAfterTheStart) {
  const ImuReplay& r = endlessReplay();
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
TEST(CameraImuGuideRounds, TheSecondTrajectoryFollowsTheFirst) {
  GuideOptions options = endless();
  options.trajectories.first = FirstTrajectory::kAtOnce;
  options.trajectories.reached_px = 1e6;
  options.trajectories.reached_s = 0.1;
  options.trajectories.duration_s = 3;
  options.trajectories.max_speed_m_s = 5;
  const ImuReplay r = imuReplayed(imuFrames(), options);
  std::vector<TimeNs> opened;
  std::optional<TimeNs> reached;
  double first_s = 0;
  for (const Decision& d : r.decisions) {
    if (d.event == SuggestionEvent::kReached && !reached) {
      reached = d.t;
      EXPECT_EQ(d.mode, GuideMode::kInitialising);
    }
    if (d.opened && opened.empty()) first_s = *d.opened->duration_s;
    if (d.opened) opened.push_back(d.t);
  }
  ASSERT_TRUE(reached);
  ASSERT_GE(opened.size(), 2u);
  EXPECT_GT(first_s, 3) << "the way to it counts";
  EXPECT_GE(secondsBetween(*reached, opened[1]), first_s);
  EXPECT_LE(secondsBetween(*reached, opened[1]), first_s + 0.1);
}

TEST(CameraImuGuideRounds, ASuggestionThatNobodyFollowsExpires) {
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

TEST(CameraImuGuideRounds, WhatWasHeldIsNotHeldOverAPause) {
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
TEST(CameraImuGuideRounds, BeginsWhenTheStageBeforeIsDone) {
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
