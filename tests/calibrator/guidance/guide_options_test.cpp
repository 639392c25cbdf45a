// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/guide_options.h"

#include <functional>
#include <limits>
#include <string>
#include <type_traits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/calibrator/base/option_refusal.h"

namespace plumbline {
namespace {

using test::refusalOf;
using ::testing::HasSubstr;

TEST(GuideOptions, TheDefaultsPass) {
  EXPECT_EQ(refusalOf<GuideOptions>([](GuideOptions&) {}), "");
}

TEST(GuideOptions, NameTheFieldAndTheRule) {
  EXPECT_EQ(refusalOf<GuideOptions>([](GuideOptions& o) { o.views.window = 0; }),
            "views.window is 0; expected 1 or more");
  EXPECT_THAT(refusalOf<GuideOptions>([](GuideOptions& o) { o.views.reached_s = -1; }),
              HasSubstr("views.reached_s is -1"));
  EXPECT_THAT(refusalOf<GuideOptions>([](GuideOptions& o) { o.trajectories.window = 1; }),
              HasSubstr("trajectories.window is 1"));
  EXPECT_THAT(refusalOf<GuideOptions>([](GuideOptions& o) { o.trajectories.window = 20; }),
              HasSubstr("trajectories.start_frames is 20; expected more than trajectories.window"));
  EXPECT_THAT(refusalOf<GuideOptions>([](GuideOptions& o) { o.latency.imu_frame_s = 61; }),
              HasSubstr("latency"));
  EXPECT_EQ(refusalOf<GuideOptions>([](GuideOptions& o) { o.views.patience = 0; }), "");
  EXPECT_EQ(refusalOf<GuideOptions>([](GuideOptions& o) { o.views.patience = -1; }),
            "views.patience is -1; expected 0 or more");
  EXPECT_THAT(refusalOf<GuideOptions>([](GuideOptions& o) { o.threads = 0; }),
              HasSubstr("threads is 0"));
}

TEST(GuideOptions, RefuseWhatIsNoNumber) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusalOf<GuideOptions>([&](GuideOptions& o) { o.views.reached_px = infinity; }),
              HasSubstr("views.reached_px is inf"));
  // As every stage does: a loss far below any detector's noise leaves no corner a weight.
  EXPECT_THAT(refusalOf<GuideOptions>([](GuideOptions& o) { o.views.cauchy_px = 1e-4; }),
              HasSubstr("cauchy_px"));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusalOf<GuideOptions>([&](GuideOptions& o) { o.views.pixel_sigma = nan; }), "");
  EXPECT_NE(refusalOf<GuideOptions>([&](GuideOptions& o) { o.trajectories.duration_s = nan; }), "");
}

TEST(GuideOptions, OfEachPartAreChecked) {
  EXPECT_EQ(refusalOf<GuideOptions>([](GuideOptions& o) { o.views.min_corners = 3; }),
            "views.min_corners is 3; expected 4 or more");
  EXPECT_EQ(refusalOf<GuideOptions>([](GuideOptions& o) { o.views.most_seen = 1; }),
            "most_seen is 1; expected 2 or more");
  EXPECT_EQ(refusalOf<GuideOptions>([](GuideOptions& o) { o.views.expires_s = 0; }),
            "views.expires_s is 0; expected a positive number");
  EXPECT_EQ(refusalOf<GuideOptions>([](GuideOptions& o) { o.trajectories.reached_s = -1; }),
            "trajectories.reached_s is -1; expected 0 or more");
  EXPECT_EQ(refusalOf<GuideOptions>([](GuideOptions& o) { o.trajectories.amplitude = 0; }),
            "trajectories.amplitude is 0; expected a positive number");
  EXPECT_EQ(refusalOf<GuideOptions>([](GuideOptions& o) { o.trajectories.distance_ratio = -1; }),
            "trajectories.distance_ratio is -1; expected a positive number");
  EXPECT_EQ(refusalOf<LissajousOptions>([](auto& o) { o.roll_rad = 4; }),
            "roll_rad is 4; expected an angle from 0 to pi");
  EXPECT_EQ(refusalOf<LissajousOptions>([](auto& o) { o.max_speed_m_s = 0; }),
            "max_speed_m_s is 0; expected a positive number");
}

}  // namespace
}  // namespace plumbline
