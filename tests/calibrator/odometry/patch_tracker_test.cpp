// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/odometry/feature_tracker.h"

namespace plumbline {
namespace {

/// A smooth texture, known everywhere, moved by (dx, dy).
GrayImage texture(double dx, double dy, double gain = 1, double level = 120) {
  GrayImage image(200, 160);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const double u = x - dx, v = y - dy;
      const double value = 40 * std::sin(0.21 * u + 0.13 * v) * std::cos(0.17 * v) +
                           30 * std::sin(0.31 * v - 0.08 * u + 1) + 15 * std::cos(0.53 * u + 2);
      image.at(x, y) = static_cast<std::uint8_t>(std::lround(level + gain * value));
    }
  }
  return image;
}

TEST(PatchTracker, FindsSubPixelMotion) {
  const double motions[][2] = {{0.3, -0.7}, {4.25, 2.5}, {-11.4, 6.6}};
  const ImagePyramid from(texture(0, 0).view(), 4);
  for (const auto& m : motions) {
    const ImagePyramid to(texture(m[0], m[1]).view(), 4);
    const Eigen::Vector2f at(90, 70);
    const auto found = trackThereAndBack(from, to, at, at, 4, {});
    ASSERT_TRUE(found) << m[0];
    EXPECT_NEAR(found->x() - at.x(), m[0], 0.03);
    EXPECT_NEAR(found->y() - at.y(), m[1], 0.03);
  }
}

TEST(PatchTracker, ExposureAndContrastDoNotMoveIt) {
  const ImagePyramid from(texture(0, 0).view(), 4), to(texture(2.4, -1.2, 0.6, 70).view(), 4);
  const Eigen::Vector2f at(100, 80);
  const auto found = trackThereAndBack(from, to, at, at, 4, {});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->x() - at.x(), 2.4, 0.05);
  EXPECT_NEAR(found->y() - at.y(), -1.2, 0.05);
  EXPECT_GT(patchCorrelation(from, to, at, *found, 0), 0.99F);
}

TEST(PatchTracker, RefusesWhatItCannotFollow) {
  const ImagePyramid from(texture(0, 0).view(), 4), flat(GrayImage(200, 160, 90).view(), 4);
  EXPECT_FALSE(trackThereAndBack(flat, flat, {90, 70}, {90, 70}, 4, {}));  // no texture
  EXPECT_FALSE(trackThereAndBack(from, flat, {90, 70}, {90, 70}, 4, {}));  // nothing alike
  EXPECT_FALSE(trackThereAndBack(from, from, {3, 70}, {3, 70}, 4, {}));    // beyond the border
  const float nan = std::nanf("");
  EXPECT_FALSE(trackThereAndBack(from, from, {90, 70}, {nan, nan}, 4, {}));
}

TEST(ImagePyramid, PlacesHalveWithTheImage) {
  GrayImage image(64, 64, 0);
  image.at(32, 24) = 255;
  const ImagePyramid pyramid(image.view(), 3);
  ASSERT_EQ(pyramid.levels(), 3);
  EXPECT_EQ(pyramid.level(1).width, 32);
  EXPECT_EQ(pyramid.level(1).at(16, 12), 36);  // 255 (6/16)^2
  EXPECT_EQ(pyramid.level(1).at(15, 12), pyramid.level(1).at(17, 12));
}

TEST(CornerPicker, FindsCornersAndKeepsItsDistance) {
  GrayImage image(160, 120, 50);
  for (int y = 40; y < 80; ++y) {
    for (int x = 50; x < 110; ++x) image.at(x, y) = 200;
  }
  const auto picked = pickCorners(image.view(), {}, {});
  ASSERT_FALSE(picked.empty());
  for (const Eigen::Vector2f& p : picked) {
    const float dx = std::min(std::abs(p.x() - 49.5F), std::abs(p.x() - 109.5F));
    const float dy = std::min(std::abs(p.y() - 39.5F), std::abs(p.y() - 79.5F));
    EXPECT_LT(std::max(dx, dy), 4) << p.transpose();  // at a corner of the square, on no edge
  }
  EXPECT_TRUE(pickCorners(GrayImage(160, 120, 90).view(), {}, {}).empty());
  for (const Eigen::Vector2f& p : pickCorners(image.view(), {{50, 40}}, {})) {
    EXPECT_GE((p - Eigen::Vector2f(50, 40)).norm(), 20);
  }
}

}  // namespace
}  // namespace plumbline
