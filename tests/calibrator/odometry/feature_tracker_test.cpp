// SPDX-License-Identifier: BSD-3-Clause
// The front end on images of a wall whose every point is known: a track is the same point of the
// wall in every frame and camera. Not proven here: real lenses, and blur.
#include "calibrator/odometry/feature_tracker.h"

#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "tests/calibrator/base/option_refusal.h"
#include "tests/calibrator/odometry/wall.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

using test::kWall_m;
using test::onWall;
using test::seenFrom;

/// Follows a rig that goes from one pose of camera 0 to the next.
class Followed {
 public:
  explicit Followed(FeatureTrackerOptions options = {}) : tracker_(rig, options) {}

  FrameTracks step(const Transform& T_WC0, bool second_camera = true) {
    const GrayImage left = seenFrom(rig, T_WC0, 0);
    const GrayImage right = second_camera ? seenFrom(rig, T_WC0, 1) : GrayImage();
    // R_SaSb by way of the cameras.
    const Eigen::Matrix3d R_before_now =
        rig.T_SC[0].R * last_.R.transpose() * T_WC0.R * rig.T_SC[0].R.transpose();
    last_ = T_WC0;
    return step(left, right, R_before_now);
  }
  FrameTracks step(const GrayImage& left, const GrayImage& right, const Eigen::Matrix3d& R) {
    const std::vector<GrayImageView> images{left.view(), right.view()};
    return tracker_.track(++t_, images, R);
  }

  RigModel rig = test::wallRig();

 private:
  FeatureTracker tracker_;
  Transform last_;
  TimeNs t_ = 0;
};

std::map<std::int64_t, Eigen::Vector2d> ofCamera(const FrameTracks& frame, int camera) {
  std::map<std::int64_t, Eigen::Vector2d> points;
  for (const TrackPoint& p : frame.points) {
    if (p.camera == camera) EXPECT_TRUE(points.emplace(p.id, p.uv).second) << p.id;
  }
  return points;
}

/// How many tracks are in both; each must be one point of the wall, to so many pixels.
int commonPoints(const RigModel& rig, const FrameTracks& a, int camera_a, const Transform& T_a,
                 const FrameTracks& b, int camera_b, const Transform& T_b, double most_px = 0.25) {
  const double most_m = most_px * kWall_m / rig.cameras[0].projection[0];
  int common = 0;
  const auto before = ofCamera(a, camera_a);
  for (const auto& [id, uv] : ofCamera(b, camera_b)) {
    const auto same = before.find(id);
    if (same == before.end()) continue;
    ++common;
    const Eigen::Vector2d there = onWall(rig, T_a, camera_a, same->second);
    EXPECT_LT((onWall(rig, T_b, camera_b, uv) - there).norm(), most_m) << id;
  }
  return common;
}

TEST(FeatureTracker, ATrackIsOnePointOfTheWall) {
  Followed followed;
  const Transform first, second(expSO3({0.02, -0.03, 0.05}), {0.05, -0.03, 0.04});
  const FrameTracks a = followed.step(first), b = followed.step(second);
  EXPECT_GT(ofCamera(a, 0).size(), 12U);
  EXPECT_GT(commonPoints(followed.rig, a, 0, first, b, 0, second), 12);
  EXPECT_GT(commonPoints(followed.rig, a, 0, first, a, 1, first), 8);
  EXPECT_GT(commonPoints(followed.rig, b, 0, second, b, 1, second), 8);
}

// A turn of some 65 pixels from frame to frame, farther than a patch is found by itself. It shows
// the wall from aside, which a translation of the patch follows to a pixel and a half.
TEST(FeatureTracker, TheGyroscopeSaysWhereToLook) {
  const Transform first, turned(expSO3({0, 0.35, 0}), {0, 0, 0});
  Followed told, untold;
  const FrameTracks before = told.step(first);
  const int found = commonPoints(told.rig, before, 0, first, told.step(turned), 0, turned, 1.5);
  EXPECT_GT(found, 8);
  untold.step(first);
  const GrayImage left = seenFrom(untold.rig, turned, 0), right = seenFrom(untold.rig, turned, 1);
  const FrameTracks lost = untold.step(left, right, Eigen::Matrix3d::Identity());
  int kept = 0;
  for (const auto& [id, uv] : ofCamera(lost, 0)) kept += ofCamera(before, 0).contains(id) ? 1 : 0;
  EXPECT_LT(2 * kept, found);
}

// A picture on the wall that somebody carries away: what it shows does not move as all else does.
TEST(FeatureTracker, WhatMovesByItselfIsDropped) {
  Followed followed;
  const Transform first, second(Eigen::Matrix3d::Identity(), {0.06, 0, 0});
  const auto isCarried = [](const Eigen::Vector2d& uv) {
    return uv.x() > 90 && uv.x() < 160 && uv.y() > 50 && uv.y() < 120;
  };
  const auto before = ofCamera(followed.step(first), 0);
  GrayImage left = seenFrom(followed.rig, second, 0);
  const GrayImage still = seenFrom(followed.rig, first, 0);
  for (int v = 40; v < 130; ++v) {
    for (int u = 80; u < 170; ++u) left.at(u, v) = still.at(u, v - 10);
  }
  const auto after = ofCamera(
      followed.step(left, seenFrom(followed.rig, second, 1), Eigen::Matrix3d::Identity()), 0);
  int carried = 0, others = 0;
  for (const auto& [id, uv] : before) {
    if (isCarried(uv)) {
      ++carried;
      EXPECT_FALSE(after.contains(id)) << uv.transpose();
    } else {
      others += after.contains(id) ? 1 : 0;
    }
  }
  EXPECT_GE(carried, 2);
  EXPECT_GE(others, 8);
}

TEST(FeatureTracker, ACameraWithoutAnImageSeesNothing) {
  Followed followed;
  const Transform first, second(Eigen::Matrix3d::Identity(), {0.02, 0, 0});
  EXPECT_TRUE(ofCamera(followed.step(first, false), 1).empty());
  const FrameTracks both = followed.step(second);
  EXPECT_GT(commonPoints(followed.rig, both, 0, second, both, 1, second), 8);
}

// The wall is 2 m away: beyond it there may be something, before it there is nothing.
TEST(FeatureTracker, NothingNearerThanTheNearestIsMatched) {
  FeatureTrackerOptions options;
  options.nearest_m = 2.5;
  Followed followed(options);
  const FrameTracks frame = followed.step(Transform());
  EXPECT_GT(ofCamera(frame, 0).size(), 12U);
  EXPECT_TRUE(ofCamera(frame, 1).empty());
}

TEST(FeatureTracker, LostPlacesAreFilledUnderNewIds) {
  Followed followed;
  std::set<std::int64_t> seen;
  std::int64_t last = -1;
  for (int k = 0; k < 4; ++k) {
    const Transform T_WC0(Eigen::Matrix3d::Identity(), {0.12 * k, 0, 0});
    const auto points = ofCamera(followed.step(T_WC0, false), 0);
    EXPECT_GT(points.size(), 12U) << k;
    std::int64_t fresh = 0;
    for (const auto& [id, uv] : points) {
      if (!seen.insert(id).second) continue;
      ++fresh;
      EXPECT_GT(id, last);
    }
    EXPECT_GE(fresh, 1) << k;
    last = *seen.rbegin();
  }
}

TEST(FeatureTracker, FollowsNoMoreThanItIsAskedTo) {
  FeatureTrackerOptions options;
  options.max_tracks = 8;
  Followed followed(options);
  EXPECT_EQ(ofCamera(followed.step(Transform(), false), 0).size(), 8U);
}

TEST(FeatureTracker, OptionsOutOfRangeAreNamed) {
  using test::refusalOf;
  EXPECT_EQ(refusalOf<FeatureTrackerOptions>([](auto& o) { o.levels = 8; }), "");
  EXPECT_THAT(refusalOf<FeatureTrackerOptions>([](auto& o) { o.levels = 9; }), HasSubstr("levels"));
  EXPECT_THAT(refusalOf<FeatureTrackerOptions>([](auto& o) { o.max_tracks = 7; }),
              HasSubstr("max_tracks"));
  EXPECT_THAT(refusalOf<FeatureTrackerOptions>([](auto& o) { o.epipolar_px = 0; }),
              HasSubstr("epipolar_px"));
  EXPECT_THAT(refusalOf<FeatureTrackerOptions>([](auto& o) { o.ransac_rounds = 0; }),
              HasSubstr("ransac_rounds"));
  EXPECT_THAT(refusalOf<FeatureTrackerOptions>([](auto& o) { o.nearest_m = NAN; }),
              HasSubstr("nearest_m"));
  EXPECT_THAT(refusalOf<FeatureTrackerOptions>([](auto& o) { o.corners.cell_px = 7; }),
              HasSubstr("cell_px"));
  EXPECT_THAT(refusalOf<FeatureTrackerOptions>([](auto& o) { o.patch.min_correlation = 1.5F; }),
              HasSubstr("min_correlation"));
}

}  // namespace
}  // namespace plumbline
