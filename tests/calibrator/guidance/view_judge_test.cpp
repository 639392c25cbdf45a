// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/views/view_judge.h"

#include <limits>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "tests/calibrator/window/stereo_frames.h"

namespace plumbline {
namespace {

/// What a judge predicts of the projections after some frames, with so many times the information.
std::optional<double> projectionPxOf(const test::StereoFrames& frames, double times) {
  const AprilGrid& target = frames.simulated.session.target;
  CameraWindow window(target, frames.simulated.truth.cameras);
  for (std::size_t f = 0; f < 6; ++f) window.add(frames.corners[f], frames.T_FC0[f]);
  ViewGuideOptions options;
  options.stop_projection_px = 0.1;
  ViewJudge judge(target, options, 1);
  judge.refresh(window, times * window.information());
  Decision d;
  judge.tell(d);
  return d.projection_px;
}

TEST(ViewJudge, AnErrorThatIsNoNumberIsNotPredictedAsNone) {
  const test::StereoFrames frames = test::stereoFrames(1, 4, 2, 0.2);
  const auto px = projectionPxOf(frames, 1), half = projectionPxOf(frames, 4);
  ASSERT_TRUE(px && half);
  EXPECT_GT(*px, 0.01);
  EXPECT_NEAR(*half / *px, 0.5, 1e-9);
  EXPECT_FALSE(projectionPxOf(frames, std::numeric_limits<double>::quiet_NaN()));
}

TEST(ViewErrorTracker, RefusesOptionsOutOfRange) {
  ViewErrorOptions options;
  options.most_seen = 1;
  EXPECT_THROW(ViewErrorTracker(AprilGrid(), options), InputError);
}

}  // namespace
}  // namespace plumbline
