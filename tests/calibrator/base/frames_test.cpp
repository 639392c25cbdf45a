// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/frames.h"

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace plumbline {
namespace {

constexpr TimeNs kMs = 1'000'000;

CameraStream streamOf(const std::vector<TimeNs>& stamps, int corners = 8) {
  CameraStream stream;
  for (TimeNs t : stamps) {
    ImageView view;
    view.t = t;
    for (int id = 0; id < corners; ++id) view.corners.push_back({id, {0, 0}});
    stream.views.push_back(view);
  }
  return stream;
}

std::vector<std::vector<int>> viewsOf(const std::vector<Frame>& frames) {
  std::vector<std::vector<int>> views;
  for (const Frame& frame : frames) views.push_back(frame.view);
  return views;
}

using Views = std::vector<std::vector<int>>;

TEST(PairFrames, SynchronisedCamerasPairOneToOne) {
  const auto frames = pairFrames({streamOf({0, 50 * kMs}), streamOf({0, 50 * kMs})});
  EXPECT_EQ(viewsOf(frames), (Views{{0, 0}, {1, 1}}));
  EXPECT_EQ(frames[1].t, 50 * kMs);
}

TEST(PairFrames, AFrameCarriesTheStampOfCamera0) {
  const TimeNs epoch = 1'700'000'000'000'000'001;
  const auto frames = pairFrames({streamOf({epoch}), streamOf({epoch + 1000})});
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].t, epoch);
}

TEST(PairFrames, AFrameWithoutCamera0CarriesTheStampThatItsWouldHave) {
  const auto frames = pairFrames({streamOf({0, 50 * kMs}), streamOf({kMs, 51 * kMs, 101 * kMs})});
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[2].view, (std::vector<int>{-1, 2}));
  EXPECT_EQ(frames[2].t, 100 * kMs);
}

TEST(PairFrames, AConstantShiftAboveTheToleranceIsTakenOut) {
  std::vector<TimeNs> first, second;
  for (int i = 0; i < 20; ++i) {
    first.push_back(i * 50 * kMs);
    second.push_back(i * 50 * kMs + 3 * kMs + i * 1000);
  }
  const auto cameras = std::vector<CameraStream>{streamOf(first), streamOf(second)};
  const auto frames = pairFrames(cameras);
  ASSERT_EQ(frames.size(), 20U);
  EXPECT_EQ(frames[7].view, (std::vector<int>{7, 7}));
  EXPECT_EQ(frames[7].t, first[7]);
  EXPECT_NEAR(static_cast<double>(stampShifts(cameras, frames)[1]), 3.01e6, 2e3);
  for (TimeNs& t : second) t += 20 * kMs;  // half-way between two frames: not the same trigger
  EXPECT_EQ(pairFrames({streamOf(first), streamOf(second)}).size(), 40U);
}

TEST(PairFrames, ToleranceIsInclusiveAndNoMore) {
  EXPECT_EQ(pairFrames({streamOf({0}), streamOf({2 * kMs})}).size(), 1U);
  EXPECT_EQ(viewsOf(pairFrames({streamOf({0}), streamOf({2 * kMs + 1})})),
            (Views{{0, -1}, {-1, 0}}));
  EXPECT_EQ(pairFrames({streamOf({0}), streamOf({9 * kMs})}, {.tolerance = 10 * kMs}).size(), 1U);
}

TEST(PairFrames, AViewIsUsedOnceAndGoesToTheNearest) {
  // Both views of camera 1 are within the tolerance of camera 0's only one.
  const auto frames = pairFrames({streamOf({10 * kMs}), streamOf({9 * kMs, 10 * kMs + 1})});
  EXPECT_EQ(viewsOf(frames), (Views{{-1, 0}, {0, 1}}));
}

TEST(PairFrames, AThirdCameraMustBeNearAllTheOthers) {
  // 0 and 1 ms pair; 3 ms is within the tolerance of the second only.
  const auto frames = pairFrames({streamOf({0}), streamOf({kMs}), streamOf({3 * kMs})});
  EXPECT_EQ(viewsOf(frames), (Views{{0, 0, -1}, {-1, -1, 0}}));
}

TEST(PairFrames, ViewsWithTooFewCornersAreLeftOut) {
  const auto cameras = std::vector<CameraStream>{streamOf({0, 50 * kMs}, 8), streamOf({0}, 3)};
  EXPECT_EQ(viewsOf(pairFrames(cameras)), (Views{{0, -1}, {1, -1}}));
  EXPECT_EQ(viewsOf(pairFrames(cameras, {.min_corners = 3})), (Views{{0, 0}, {1, -1}}));
  EXPECT_TRUE(pairFrames({streamOf({0}, 0), streamOf({0}, 0)}).empty());
}

TEST(PairFrames, NothingGivesNothing) {
  EXPECT_TRUE(pairFrames({}).empty());
  EXPECT_TRUE(pairFrames({CameraStream{}, CameraStream{}}).empty());
}

// Three cameras with jitter, dropped views and a drift of their own.
std::vector<CameraStream> untidyCameras(int seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<TimeNs> jitter(-3 * kMs / 2, 3 * kMs / 2);
  std::vector<CameraStream> cameras;
  for (int c = 0; c < 3; ++c) {
    std::vector<TimeNs> stamps;
    for (int i = 0; i < 200; ++i) {
      const TimeNs t = i * 4 * kMs + jitter(random);
      if (random() % 10 != 0 && (stamps.empty() || t > stamps.back())) stamps.push_back(t);
    }
    cameras.push_back(streamOf(stamps));
  }
  return cameras;
}

TEST(PairFrames, NeverUsesAViewTwiceNorExceedsTheTolerance) {
  for (int seed = 1; seed <= 20; ++seed) {
    const auto cameras = untidyCameras(seed);
    const auto frames = pairFrames(cameras);
    std::map<int, std::set<int>> used;
    std::size_t views = 0;
    for (const Frame& frame : frames) {
      std::vector<TimeNs> stamps;
      for (int c = 0; c < 3; ++c) {
        if (frame.view[c] < 0) continue;
        EXPECT_TRUE(used[c].insert(frame.view[c]).second) << "view " << frame.view[c] << " twice";
        stamps.push_back(cameras[c].views[frame.view[c]].t);
        ++views;
      }
      const auto [first, last] = std::minmax_element(stamps.begin(), stamps.end());
      EXPECT_LE(*last - *first, FrameOptions().tolerance);
    }
    EXPECT_EQ(views, cameras[0].views.size() + cameras[1].views.size() + cameras[2].views.size());
    EXPECT_TRUE(std::is_sorted(frames.begin(), frames.end(),
                               [](const Frame& a, const Frame& b) { return a.t < b.t; }));
  }
}

TEST(PairFrames, DoesNotDependOnTheOrderOfTheCameras) {
  for (int seed = 1; seed <= 20; ++seed) {
    const auto cameras = untidyCameras(seed);
    std::set<std::vector<int>> expected;
    for (const Frame& frame : pairFrames(cameras)) expected.insert(frame.view);
    std::set<std::vector<int>> turned;
    for (const Frame& frame : pairFrames({cameras[2], cameras[0], cameras[1]})) {
      turned.insert({frame.view[1], frame.view[2], frame.view[0]});
    }
    EXPECT_EQ(turned, expected) << "seed " << seed;
  }
}

}  // namespace
}  // namespace plumbline
