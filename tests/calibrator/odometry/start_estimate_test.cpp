// SPDX-License-Identifier: BSD-3-Clause
// The start of an odometry from exact sightings of a rig in motion, and what it needs.
#include "calibrator/odometry/start_estimate.h"

#include <gtest/gtest.h>

#include "tests/calibrator/odometry/exact_window.h"

namespace plumbline {
namespace {

using test::ExactWindow;

/// What the frames of a window see, by the first so many cameras.
std::vector<StartFrame> framesOf(const ExactWindow& x, double sigma_px, int cameras = 2) {
  std::vector<StartFrame> frames;
  for (std::size_t k = 0; k < x.window.frames.size(); ++k) {
    StartFrame& frame = frames.emplace_back(StartFrame{x.window.frames[k].t, {}});
    for (const auto& [id, landmark] : x.window.landmarks) {
      for (int camera = 0; camera < cameras; ++camera) {
        const Eigen::Vector2d uv = x.pixelOf(*landmark.p_W, k, camera);
        frame.seen.emplace_back(id, x.rig.sighting(camera, uv, sigma_px).value());
      }
    }
  }
  return frames;
}

ExactWindow inMotion(int frames, double interval_s = 0.1) {
  ExactWindow x(frames, interval_s);
  x.addLandmarks(1, 0, static_cast<std::size_t>(frames) - 1);
  return x;
}

// Position and yaw are free: the estimate is the truth, turned about the vertical.
TEST(StartEstimate, FindsMotionGravityAndBiases) {
  const ExactWindow x = inMotion(8);
  const auto start = startEstimate(framesOf(x, 0.01), x.samples, x.rig, {});
  ASSERT_TRUE(start);
  ASSERT_EQ(start->states.size(), 8U);
  EXPECT_LT(start->rms, 0.1);
  const ImuState& first = x.window.frames.front().state;
  const Eigen::Matrix3d R_EW = start->states.front().T_FS.R * first.T_FS.R.transpose();
  EXPECT_LT((R_EW.col(2) - Eigen::Vector3d::UnitZ()).norm(), 2e-3) << "level";
  EXPECT_TRUE(start->states.front().T_FS.t.isZero(1e-12));
  for (std::size_t k = 0; k < 8; ++k) {
    const ImuState &found = start->states[k], &truth = x.window.frames[k].state;
    EXPECT_LT((found.T_FS.t - R_EW * (truth.T_FS.t - first.T_FS.t)).norm(), 2e-3) << k;
    EXPECT_LT((found.v_F - R_EW * truth.v_F).norm(), 5e-3) << k;
    EXPECT_LT((found.gyro_bias - truth.gyro_bias).norm(), 1e-3) << k;
    EXPECT_LT(rotationAngle((R_EW * truth.T_FS.R).transpose() * found.T_FS.R), 2e-3) << k;
  }
}

TEST(StartEstimate, NeedsFourFramesAndEnoughPointsSeenThreeTimes) {
  const ExactWindow x = inMotion(8);
  std::vector<StartFrame> frames = framesOf(x, 0.1);
  const auto starts = [&](const StartOptions& options) {
    return startEstimate(frames, x.samples, x.rig, options).has_value();
  };
  StartOptions options;
  options.min_landmarks = 16;
  EXPECT_TRUE(starts(options));
  options.min_landmarks = 17;
  EXPECT_FALSE(starts(options));
  options.min_landmarks = 16;
  // One of the sixteen is seen by both cameras of the first frame, and no more.
  for (std::size_t k = 1; k < frames.size(); ++k) {
    std::erase_if(frames[k].seen, [](const auto& s) { return s.first == 5; });
  }
  EXPECT_FALSE(starts(options));
  frames.resize(3);
  options.min_landmarks = 4;
  EXPECT_FALSE(starts(options));
}

TEST(StartEstimate, NeedsSamplesFromTheFirstFrameToTheLast) {
  const ExactWindow x = inMotion(6);
  const std::vector<StartFrame> frames = framesOf(x, 0.1);
  const auto starts = [&](TimeNs from, TimeNs to) {
    std::vector<ImuSample> samples = x.samples;
    std::erase_if(samples, [&](const ImuSample& s) { return s.t < from || s.t > to; });
    return startEstimate(frames, samples, x.rig, {}).has_value();
  };
  const TimeNs offset = toNanoseconds(x.rig.time_offset_s);
  const TimeNs first = frames.front().t + offset, last = frames.back().t + offset;
  EXPECT_TRUE(starts(first, last));
  EXPECT_FALSE(starts(first + 1, last));
  EXPECT_FALSE(starts(first, last - 1));
}

// Over a moment one camera's points may be near and slow or far and fast alike.
TEST(StartEstimate, OneCameraNeedsMoreMotionThanTwo) {
  const ExactWindow brief = inMotion(5, 0.05), longer = inMotion(12);
  EXPECT_TRUE(startEstimate(framesOf(brief, 1), brief.samples, brief.rig, {}));
  EXPECT_FALSE(startEstimate(framesOf(brief, 1, 1), brief.samples, brief.rig, {}));
  EXPECT_TRUE(startEstimate(framesOf(longer, 0.1, 1), longer.samples, longer.rig, {}));
}

// Whoever knows that the rig stands, or believes so, is followed as far as he trusts it.
TEST(StartEstimate, AVelocityThatIsToldCounts) {
  const ExactWindow x = inMotion(8);
  StartOptions standing;
  standing.velocity_sigma = 1e-4;
  standing.max_rms = 1e6;
  const auto told = startEstimate(framesOf(x, 1), x.samples, x.rig, standing);
  ASSERT_TRUE(told);
  EXPECT_LT(told->states.front().v_F.norm(), 0.01);
  EXPECT_LE(told->velocity_std, 1.001e-4);
}

}  // namespace
}  // namespace plumbline
