// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/guide_options.h"

#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

std::string refusalOf(const std::function<void(GuideOptions&)>& change) {
  GuideOptions options;
  change(options);
  try {
    options.check();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(GuideOptions, TheDefaultsPass) {
  EXPECT_EQ(refusalOf([](GuideOptions&) {}), "");
}

TEST(GuideOptions, NameTheFieldAndTheRule) {
  EXPECT_EQ(refusalOf([](GuideOptions& o) { o.views.window = 0; }),
            "views.window is 0; expected 1 or more");
  EXPECT_THAT(refusalOf([](GuideOptions& o) { o.views.reached_s = -1; }),
              HasSubstr("views.reached_s is -1"));
  EXPECT_THAT(refusalOf([](GuideOptions& o) { o.trajectories.window = 1; }),
              HasSubstr("trajectories.window is 1"));
  EXPECT_THAT(refusalOf([](GuideOptions& o) { o.trajectories.window = 20; }),
              HasSubstr("trajectories.start_frames is 20; expected more than trajectories.window"));
  EXPECT_THAT(refusalOf([](GuideOptions& o) { o.latency.imu_frame_s = 61; }), HasSubstr("latency"));
  EXPECT_THAT(refusalOf([](GuideOptions& o) { o.threads = 0; }), HasSubstr("threads is 0"));
}

TEST(GuideOptions, RefuseWhatIsNoNumber) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusalOf([&](GuideOptions& o) { o.views.reached_px = infinity; }),
              HasSubstr("views.reached_px is inf"));
  // As every stage does: a loss far below any detector's noise leaves no corner a weight.
  EXPECT_THAT(refusalOf([](GuideOptions& o) { o.views.cauchy_px = 1e-4; }), HasSubstr("cauchy_px"));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusalOf([&](GuideOptions& o) { o.views.pixel_sigma = nan; }), "");
  EXPECT_NE(refusalOf([&](GuideOptions& o) { o.trajectories.duration_s = nan; }), "");
}

}  // namespace
}  // namespace plumbline
