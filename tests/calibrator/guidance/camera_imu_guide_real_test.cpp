// SPDX-License-Identifier: BSD-3-Clause
// The camera-IMU stage over EuRoC's imu_april with the published cameras: when it finishes, and its
// window beside the batch over all frames.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/guidance/imu_stage_tracker.h"
#include "tests/calibrator/batch/euroc_recording.h"
#include "tests/calibrator/guidance/imu_guide_replay.h"

namespace plumbline {
namespace {

const test::EurocRecording& recording() {
  static const test::EurocRecording r = test::readEurocRecording(PLUMBLINE_SHARED_DATA);
  return r;
}

GuideRig rig() {
  GuideRig out;
  out.target = recording().session.target;
  out.imu = recording().session.imu->noise;
  for (const CameraCalibration& c : recording().published) {
    out.cameras.push_back({c.name, c.intrinsics.resolution, {}});
  }
  return out;
}

const CameraImuStageResult& allFrames() {
  static const CameraImuStageResult r =
      calibrateCameraImu(recording().session, recording().published).value();
  return r;
}

struct Replay {
  std::vector<Decision> decisions;
  CameraImuGuide guide;
};
Replay replayed(const GuideOptions& options) {
  Replay r{{}, {rig(), recording().published, options}};
  r.decisions = test::replay(r.guide, test::framesOf(recording().session));
  return r;
}

/// Seconds of the recording at which a mode is entered; negative: never.
double secondsUntil(const std::vector<Decision>& decisions, GuideMode mode) {
  for (const Decision& d : decisions) {
    if (d.mode == mode) return secondsBetween(decisions.front().t, d.t);
  }
  return -1;
}

double millimetresApart(const Transform& a, const Transform& b) { return 1e3 * (a.t - b.t).norm(); }
double milliradiansApart(const Transform& a, const Transform& b) {
  return 1e3 * boxminus(a, b).tail<3>().norm();
}

// At 0.2 bits some trajectory would still tell more when the recording ends: the stage keeps all of
// it, cut at the pause of 1.15 s that its frames make.
TEST(CameraImuGuideEuroc, AtItsThresholdItAsksForMoreThanTheRecordingHas) {
  const Replay r = replayed({});
  EXPECT_EQ(secondsUntil(r.decisions, GuideMode::kFinished), -1);
  // The second trajectory, after the first, of which the estimate started on the way.
  EXPECT_LT(secondsUntil(r.decisions, GuideMode::kSuggesting), 7);
  EXPECT_EQ(std::count_if(r.decisions.begin(), r.decisions.end(),
                          [](const Decision& d) { return d.reason == GuideReason::kNotSolved; }),
            0);
  const auto result = r.guide.batch();
  ASSERT_TRUE(result) << result.failure();
  EXPECT_LT(millimetresApart(result->imu.T_SC0, allFrames().imu.T_SC0), 0.3);
  EXPECT_LT(milliradiansApart(result->imu.T_SC0, allFrames().imu.T_SC0), 0.3);
}

TEST(CameraImuGuideEuroc, WithMoreToAskForItFinishesNearTheBatchOverAllFrames) {
  GuideOptions options;
  options.trajectories = GuideOptions::patient().trajectories;
  options.trajectories.threshold_nats = 0.5 * std::log(2.0);
  const Replay r = replayed(options);
  const double finished_s = secondsUntil(r.decisions, GuideMode::kFinished);
  EXPECT_GT(finished_s, 40);
  EXPECT_LT(finished_s, 55);
  const auto result = r.guide.batch();
  ASSERT_TRUE(result) << result.failure();
  EXPECT_LT(millimetresApart(result->imu.T_SC0, allFrames().imu.T_SC0), 1.5);
  EXPECT_LT(milliradiansApart(result->imu.T_SC0, allFrames().imu.T_SC0), 1);
}

// The window holds the time offset of its start: what it ends with is near the batch all the same.
TEST(CameraImuGuideEuroc, TheWindowEndsNearTheBatch) {
  ImuStageRecording kept(rig(), {});
  std::optional<ImuStageTracker> tracker;
  Decision decision;
  for (const GuideFrame& frame : test::framesOf(recording().session)) {
    const auto taken = static_cast<std::size_t>(kept.addSamples(frame.imu));
    if (tracker) tracker->addSamples(std::span(kept.samples()).last(taken));
    auto posed = poseFrame(frame, rig().target, recording().published, 16, 30);
    if (!posed) continue;
    kept.keep(*posed);
    if (tracker) {
      tracker->add(std::move(*posed));
      tracker->drain(kept, decision);
    } else if (kept.frames().size() == 60) {
      auto start = startImuWindow(kept, recording().published, {});
      ASSERT_TRUE(start) << start.failure();
      tracker.emplace(std::move(start).value().window, GuideOptions().max_frame_gap_s);
    }
  }
  const CameraImuEstimate& e = tracker->window().estimate();
  RecordProperty("apart_mm", std::to_string(millimetresApart(e.T_SC0, allFrames().imu.T_SC0)));
  RecordProperty("apart_mrad", std::to_string(milliradiansApart(e.T_SC0, allFrames().imu.T_SC0)));
  RecordProperty("held_offset_ms", std::to_string(1e3 * e.timeOffset()));
  EXPECT_LT(millimetresApart(e.T_SC0, allFrames().imu.T_SC0), 2);
  EXPECT_LT(milliradiansApart(e.T_SC0, allFrames().imu.T_SC0), 2);
}

}  // namespace
}  // namespace plumbline
