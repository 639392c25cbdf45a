// SPDX-License-Identifier: BSD-3-Clause
// The guide over its stages: a camera stage whose time is over.
#include "calibrator/guidance/guide.h"

#include <algorithm>
#include <optional>

#include <gtest/gtest.h>

#include "tests/calibrator/guidance/camera_guide_replay.h"

namespace plumbline {
namespace {

constexpr double kRate = 10;  // [Hz]

/// Two seconds of a free motion, then held still, so that the guide asks for a view.
std::vector<Decision> played(Guide& guide, const test::LiveRig& rig, int frames) {
  std::vector<Decision> decisions;
  for (int i = 0; i < frames; ++i) {
    const double t = i / kRate;
    decisions.push_back(guide.step(rig.frame(i, t, rig.wandering(std::min(t, 2.0)))));
  }
  return decisions;
}

std::vector<Decision> endedAfter(double seconds, int frames) {
  const test::LiveRig rig("euroc", 1, 0.2);
  GuideOptions options;
  options.camera_stage_s = seconds;
  options.views.patience = 3;  // not with the first frame, with which no stage can end
  Guide guide(rig.guideRig(), options);
  auto decisions = played(guide, rig, frames);
  EXPECT_EQ(guide.cameraStageEnded(), seconds > 0);
  EXPECT_EQ(guide.finished(), seconds > 0);
  return decisions;
}

std::size_t openedAt(const std::vector<Decision>& decisions) {
  const auto opened = std::find_if(decisions.begin(), decisions.end(),
                                   [](const Decision& d) { return d.opened.has_value(); });
  return static_cast<std::size_t>(opened - decisions.begin());
}

/// A stage that goes on, shared: it asks for a view in the end.
const std::vector<Decision>& withoutEnd() {
  static const std::vector<Decision> decisions = endedAfter(0, 60);
  return decisions;
}

TEST(Guide, ACameraStageWhoseTimeIsOverEndsWithThatFrame) {
  const auto decisions = endedAfter(1, 20);
  for (std::size_t i = 0; i < decisions.size(); ++i) {
    EXPECT_EQ(decisions[i].mode == GuideMode::kFinished, i >= 10) << i;
    EXPECT_EQ(decisions[i].reason == GuideReason::kFinished, i > 10) << i;
  }
  EXPECT_NE(decisions[10].detail, "");
}

/// 20 frames of a camera stage of so many seconds, one of them with a wrong stamp.
std::vector<Decision> withAWrongStamp(int wrong, double stage_s, double stamp_s = 1000) {
  const test::LiveRig rig("euroc", 1, 0.2);
  GuideOptions options;
  options.camera_stage_s = stage_s;
  Guide guide(rig.guideRig(), options);
  std::vector<Decision> decisions;
  for (int i = 0; i < 20; ++i) {
    const double t = i / kRate;
    decisions.push_back(guide.step(rig.frame(i, i == wrong ? stamp_s : t, rig.wandering(t))));
  }
  return decisions;
}

TEST(Guide, AWrongStampFarAheadDoesNotEndTheCameraStage) {
  const auto decisions = withAWrongStamp(10, 30);
  for (std::size_t i = 0; i < decisions.size(); ++i) {
    EXPECT_EQ(decisions[i].reason == GuideReason::kTimeJump, i == 10) << i;
    EXPECT_NE(decisions[i].mode, GuideMode::kFinished) << i;
  }
}

TEST(Guide, TimeBeginsWithTheFramesThatReplaceAFirstOneInEitherStage) {
  const test::LiveRig live("euroc", 1, 0.2);
  GuideRig rig = live.guideRig();
  rig.imu.emplace();
  for (const bool given : {false, true}) {
    Guide guide(rig, GuideOptions(), given ? std::optional(live.truth()) : std::nullopt);
    EXPECT_EQ(guide.since(), std::nullopt);
    const double stamps_s[] = {-1000, 0, 0.1, 0.2};
    std::vector<TimeNs> stamps;
    for (int i = 0; i < 4; ++i) {
      const GuideFrame frame = live.frame(i, stamps_s[i], live.wandering(stamps_s[i]));
      stamps.push_back(frame.t);
      guide.step(frame);
      EXPECT_EQ(guide.since(), stamps[i < 2 ? 0 : 2]) << i << ", given: " << given;
    }
  }
}

TEST(Guide, AWrongStampOfTheFirstFrameLeavesOutThatFrameAlone) {
  for (const double stamp_s : {1000.0, -1000.0}) {
    const auto decisions = withAWrongStamp(0, 1, stamp_s);
    for (std::size_t i = 0; i < decisions.size(); ++i) {
      EXPECT_EQ(decisions[i].reason == GuideReason::kTimeJump, i == 1) << i;
      EXPECT_EQ(decisions[i].withdrawn, i == 2 ? std::vector<int>{0} : std::vector<int>{}) << i;
      // A second after the first that is in order.
      EXPECT_EQ(decisions[i].mode == GuideMode::kFinished, i >= 12) << i;
    }
  }
}

TEST(Guide, ASuggestionThatIsOpenThenIsWithdrawn) {
  const auto& free = withoutEnd();
  const std::size_t opened = openedAt(free);
  ASSERT_LT(opened + 2, free.size());
  const auto ended =
      endedAfter(static_cast<double>(opened + 2) / kRate, static_cast<int>(opened) + 5);
  EXPECT_EQ(ended[opened + 2].event, SuggestionEvent::kWithdrawn);
  EXPECT_EQ(ended[opened + 2].suggestion, free[opened].suggestion);
}

TEST(Guide, ASuggestionOfTheLastFrameIsNeverShown) {
  const auto& free = withoutEnd();
  const std::size_t opened = openedAt(free);
  ASSERT_LT(opened, free.size());
  const auto ended = endedAfter(static_cast<double>(opened) / kRate, static_cast<int>(opened) + 5);
  EXPECT_EQ(ended[opened].mode, GuideMode::kFinished);
  EXPECT_EQ(ended[opened].event, SuggestionEvent::kNone);
  EXPECT_FALSE(ended[opened].opened || ended[opened].suggestion);
}

TEST(Guide, TheIdOfASuggestionThatWasNeverShownIsGivenAgain) {
  const auto opened = static_cast<int>(openedAt(withoutEnd()));
  const test::LiveRig rig("euroc", 1, 0.2);
  GuideRig sensors = rig.guideRig();
  sensors.imu = ImuNoise();
  GuideOptions options;
  options.camera_stage_s = opened / kRate;
  options.views.patience = 3;
  Guide guide(sensors, options);
  std::optional<Suggestion> asked;
  for (int i = 0; i < opened + 5 && !asked; ++i) {
    const double t = i / kRate;
    GuideFrame frame = rig.frame(i, t, rig.wandering(std::min(t, 2.0)));
    for (int k = 0; k < 20; ++k) {
      ImuSample& sample = frame.imu.emplace_back();
      sample.t = frame.t + (k - 19) * 5'000'000LL;
      sample.accel = {0, 0, 9.81};
    }
    asked = guide.step(frame).opened;
  }
  ASSERT_TRUE(asked);
  EXPECT_EQ(asked->stage, GuideStage::kCameraImu);
  EXPECT_EQ(asked->id, 0);
}

}  // namespace
}  // namespace plumbline
