// SPDX-License-Identifier: BSD-3-Clause
// Which frames take part, and how the IMU joins them.
#include <algorithm>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/batch/camera_imu/frame_selection.h"
#include "calibrator/batch/camera_imu/posed_frames.h"
#include "calibrator/batch/camera_imu/stage.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

constexpr TimeNs kMs = 1'000'000;

ImuSample restingAt(TimeNs t) {
  ImuSample sample;
  sample.t = t;
  return sample;
}

/// Samples every 5 ms over [0, 1] s without those in (from, to).
std::vector<ImuSample> samplesWithGap(TimeNs from, TimeNs to) {
  std::vector<ImuSample> samples;
  for (TimeNs t = 0; t <= 1000 * kMs; t += 5 * kMs) {
    if (t <= from || t >= to) samples.push_back(restingAt(t));
  }
  return samples;
}

std::vector<TimeNs> everyFifty(TimeNs first, TimeNs last) {
  std::vector<TimeNs> stamps;
  for (TimeNs t = first; t <= last; t += 50 * kMs) stamps.push_back(t);
  return stamps;
}

TEST(ShiftedSamples, AreExactAtTheEpoch) {
  const TimeNs epoch = 1'404'733'405'747'800'064;
  const auto moved = shiftedSamples({restingAt(epoch)}, -3'210'001);
  EXPECT_EQ(moved[0].t, epoch - 3'210'001);
}

TEST(ImuGaps, AreThoseLongerThanSomeMedianIntervals) {
  const auto samples = samplesWithGap(500 * kMs, 530 * kMs);
  const auto gaps = imuGaps(samples, 5);
  ASSERT_EQ(gaps.size(), 1u);
  EXPECT_EQ(gaps[0].from, 500 * kMs);
  EXPECT_EQ(gaps[0].to, 530 * kMs);
  EXPECT_TRUE(imuGaps(samples, 7).empty());
  EXPECT_TRUE(imuGaps({}, 5).empty());
}

TEST(SelectFrames, TakesThoseThatSamplesCoverAfterTheOffset) {
  const auto samples = samplesWithGap(0, 0);
  const auto stamps = everyFifty(-200 * kMs, 1200 * kMs);
  FrameSelectionOptions options;
  options.time_offset_s = 0.1;  // IMU [0, 1] s is [-0.1, 0.9] s of the camera's clock
  options.margin_s = 0.005;
  const FrameSelection s = selectFrames(stamps, samples, {}, options);
  ASSERT_FALSE(s.chosen.empty());
  EXPECT_EQ(stamps[static_cast<std::size_t>(s.chosen.front())], -50 * kMs);
  EXPECT_EQ(stamps[static_cast<std::size_t>(s.chosen.back())], 850 * kMs);
  EXPECT_EQ(s.links.size(), s.chosen.size() - 1);
  EXPECT_EQ(s.covered, static_cast<int>(s.chosen.size()));
}

TEST(SelectFrames, AGapBreaksOneLinkAndDropsTheFramesInside) {
  const auto samples = samplesWithGap(410 * kMs, 540 * kMs);
  const auto stamps = everyFifty(50 * kMs, 950 * kMs);
  const auto gaps = imuGaps(samples, 5);
  const FrameSelection s = selectFrames(stamps, samples, gaps, {});
  // 450 and 500 ms lie in the gap; 400 and 550 ms are joined across it by the biases alone.
  EXPECT_EQ(s.chosen.size(), stamps.size() - 2);
  EXPECT_EQ(s.covered, static_cast<int>(stamps.size()));
  int walks = 0;
  for (std::size_t k = 0; k < s.links.size(); ++k) {
    if (s.links[k] != FrameLink::kBiasWalk) continue;
    ++walks;
    EXPECT_EQ(stamps[static_cast<std::size_t>(s.chosen[k])], 400 * kMs);
    EXPECT_EQ(stamps[static_cast<std::size_t>(s.chosen[k + 1])], 550 * kMs);
  }
  EXPECT_EQ(walks, 1);
}

// Pauses are on the IMU's clock, frames on the camera's: t_imu = t_cam + t_d.
TEST(SelectFrames, AGapLiesWhereTheOffsetPutsIt) {
  const auto samples = samplesWithGap(410 * kMs, 540 * kMs);
  const auto stamps = everyFifty(150 * kMs, 850 * kMs);
  for (const int offset_ms : {-100, 100}) {
    FrameSelectionOptions options;
    options.time_offset_s = 1e-3 * offset_ms;
    const FrameSelection s = selectFrames(stamps, samples, imuGaps(samples, 5), options);
    ASSERT_EQ(s.chosen.size(), stamps.size() - 2) << offset_ms;
    const auto walk = std::find(s.links.begin(), s.links.end(), FrameLink::kBiasWalk);
    ASSERT_NE(walk, s.links.end());
    const auto before = s.chosen[static_cast<std::size_t>(walk - s.links.begin())];
    EXPECT_EQ(stamps[static_cast<std::size_t>(before)] + offset_ms * kMs, 400 * kMs);
  }
}

// The solution moves the offset yet, and a window with it.
TEST(SelectFrames, AFrameNextToAGapIsJoinedOnlyWhereTheMarginIsKept) {
  const auto samples = samplesWithGap(400 * kMs, 440 * kMs);
  const std::vector<TimeNs> stamps = {350 * kMs, 394 * kMs, 450 * kMs, 500 * kMs};
  for (const auto& [margin_s, chosen] : {std::pair{0.005, 4u}, std::pair{0.007, 2u}}) {
    FrameSelectionOptions options;
    options.margin_s = margin_s;
    // Where 350 and 394 ms are not joined, neither has another neighbour.
    EXPECT_EQ(selectFrames(stamps, samples, imuGaps(samples, 5), options).chosen.size(), chosen);
  }
}

TEST(WanderingStamps, PartsDifferByMillisecondsAndByTenDeviations) {
  EXPECT_FALSE(wanderingStamps({}));
  EXPECT_FALSE(wanderingStamps(PartOffsets{0.001, 0.0055, 1e-5}));  // 4.5 ms
  EXPECT_FALSE(wanderingStamps(PartOffsets{-0.01, 0.01, 0.0021}));  // of noisy rates
  const auto found = wanderingStamps(PartOffsets{-0.01, 0.01, 0.0019});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->code, FailureCode::kStampsWander);
  EXPECT_EQ(found->number("from_s"), -0.01);
  EXPECT_EQ(found->number("to_s"), 0.01);
  EXPECT_TRUE(wanderingStamps(PartOffsets{0.001, 0.0065, 1e-5}));
}

TEST(SelectFrames, FramesFarApartAreJoinedByTheBiasWalkOnly) {
  const auto samples = samplesWithGap(0, 0);
  const std::vector<TimeNs> stamps = {50 * kMs, 100 * kMs, 700 * kMs, 750 * kMs};
  FrameSelectionOptions options;
  options.max_interval_s = 0.5;
  const FrameSelection s = selectFrames(stamps, samples, {}, options);
  ASSERT_EQ(s.links.size(), 3u);
  EXPECT_EQ(s.links[0], FrameLink::kInertial);
  EXPECT_EQ(s.links[1], FrameLink::kBiasWalk);
  EXPECT_EQ(s.links[2], FrameLink::kInertial);
}

TEST(SelectFrames, WithoutSamplesThereAreNone) {
  const std::vector<TimeNs> stamps = {0, kMs};
  EXPECT_TRUE(selectFrames(stamps, {}, {}, {}).chosen.empty());
}

// Corners of a misplaced tag that have no weight are no false ones, and take none away from them.
TEST(PoseFrames, FalseCornersAreCountedBesideMisplacedTags) {
  SimulationOptions simulation;
  simulation.duration_s = 0.2;
  SimulatedSession s = simulateSession(simulatedRig("euroc"), simulation);
  s.session.cameras.resize(1);
  s.truth.cameras.resize(1);
  s.session.cameras[0].views.resize(1);
  std::vector<Corner>& corners = s.session.cameras[0].views[0].corners;
  // Positions of the first corners of whole tags.
  std::vector<std::size_t> tags;
  for (std::size_t k = 0; k + 3 < corners.size(); ++k) {
    if (corners[k].id % 4 == 0 && corners[k + 3].id == corners[k].id + 3) tags.push_back(k);
  }
  ASSERT_GT(tags.size(), 10u);
  for (std::size_t i = 0; i < 4; ++i) std::swap(corners[tags[1] + i].uv, corners[tags[6] + i].uv);
  for (const std::size_t tag : {tags[3], tags[8]}) corners[tag].uv.x() += 60;
  std::vector<PackedCorners> packed = packCorners(s.session);
  for (const std::size_t tag : {tags[1], tags[6]}) {
    for (std::size_t i = 0; i < 4; ++i) packed[0].setWeight(0, static_cast<int>(tag + i), 0);
  }
  const PosedFrames posed = poseFrames(s.session, packed, s.truth.cameras, {});
  ASSERT_EQ(posed.frames.size(), 1u);
  EXPECT_EQ(posed.screening.misplaced_tags.size(), 2u);
  EXPECT_EQ(posed.screening.false_corners, 2u);
}

}  // namespace
}  // namespace plumbline
