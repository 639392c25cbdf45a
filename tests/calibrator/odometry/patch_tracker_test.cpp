// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>
#include <optional>
#include <utility>
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

// A view into a larger image: rows are farther apart than they are long.
TEST(ImagePyramid, ReadsAViewRowByRow) {
  GrayImage image(80, 40, 10);
  for (int y = 0; y < 40; ++y) {
    for (int x = 40; x < 80; ++x) image.at(x, y) = 200;
  }
  const ImagePyramid left({image.data(), 40, 40, 80}, 2), right({image.data() + 40, 40, 40, 80}, 2);
  ASSERT_EQ(left.levels(), 2);
  for (const int k : {0, 1}) {
    for (const int y : {0, left.level(k).height - 1}) {
      for (const int x : {0, left.level(k).width - 1}) {
        EXPECT_EQ(left.level(k).at(x, y), 10);
        EXPECT_EQ(right.level(k).at(x, y), 200);
      }
    }
  }
}

TEST(ImagePyramid, EndsWhereAPatchWouldNoLongerFit) {
  EXPECT_EQ(ImagePyramid(GrayImage(40, 31).view(), 4).levels(), 1);
  EXPECT_EQ(ImagePyramid(GrayImage(40, 32).view(), 4).levels(), 2);
  EXPECT_EQ(ImagePyramid(GrayImage(70, 65).view(), 4).levels(), 3);
  EXPECT_EQ(ImagePyramid(GrayImage(70, 65).view(), 4).level(1).height, 33);
}

/// Paints a roof: a pyramid that falls by `slope` grey levels a pixel along x and along y.
void addRoof(GrayImage& image, int x0, int y0, int slope) {
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const int level = 250 - slope * (std::abs(x - x0) + std::abs(y - y0));
      if (level > image.at(x, y)) image.at(x, y) = static_cast<std::uint8_t>(level);
    }
  }
}

// On a ridge of the roof one gradient is +-5 but in the middle one of seven columns, and does not
// correlate with the other: 25 * 6 / 7 is the smaller eigenvalue.
TEST(CornerPicker, TheBoundIsOfTheMeanSquaredGradient) {
  GrayImage image(120, 120, 0);
  addRoof(image, 60, 60, 5);
  CornerPickerOptions options;
  options.min_eigenvalue = 21.4;
  EXPECT_FALSE(pickCorners(image.view(), {}, options).empty());
  for (const Eigen::Vector2f& p : pickCorners(image.view(), {}, options)) {
    EXPECT_TRUE(p.x() == 60 || p.y() == 60) << p.transpose();
  }
  options.min_eigenvalue = 21.5;
  EXPECT_TRUE(pickCorners(image.view(), {}, options).empty());
}

TEST(CornerPicker, TheStrongestComeFirstAndOneACell) {
  GrayImage image(184, 64, 0);
  for (const auto& [x0, slope] : {std::pair{32, 10}, {72, 20}, {112, 15}})
    addRoof(image, x0, 32, slope);
  const auto picked = pickCorners(image.view(), {}, {});  // cells of 40 px from 12 on
  ASSERT_EQ(picked.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(picked[i].x(), (std::array{72, 112, 32})[i], 13);
  }
  // What is tracked already leaves its cell as it is, wherever in the cell it lies.
  const auto others = pickCorners(image.view(), {{90, 13}}, {});
  ASSERT_EQ(others.size(), 2U);
  EXPECT_NEAR(others[0].x(), 112, 13);
}

TEST(CornerPicker, KeepsClearOfTheBorder) {
  GrayImage image(100, 90);
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 100; ++x) image.at(x, y) = (x / 5 + y / 5) % 2 == 0 ? 30 : 220;
  }
  CornerPickerOptions dense;
  dense.cell_px = 8;
  dense.min_distance_px = 0;
  const auto picked = pickCorners(image.view(), {}, dense);
  EXPECT_GT(picked.size(), 50U);
  for (const Eigen::Vector2f& p : picked) {
    EXPECT_GE(std::min(p.x(), p.y()), 12);
    EXPECT_LT(p.x(), 100 - 12);
    EXPECT_LT(p.y(), 90 - 12);
  }
}

TEST(PatchCorrelation, IsThatOfOnePlaceAndOfTheOppositeGreyLevels) {
  const GrayImage image = texture(0, 0);
  GrayImage negative = image;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) negative.at(x, y) = 255 - image.at(x, y);
  }
  const ImagePyramid from(image.view(), 3), to(negative.view(), 3);
  EXPECT_NEAR(patchCorrelation(from, from, {90, 70}, {90, 70}, 0), 1, 1e-4);
  EXPECT_NEAR(patchCorrelation(from, to, {90, 70}, {90, 70}, 0), -1, 1e-4);
  EXPECT_LT(patchCorrelation(from, from, {90, 70}, {100, 70}, 0), 0.9F);
  EXPECT_NEAR(patchCorrelation(from, from, {90, 70}, {90, 70}, 2), 1, 1e-4);
  EXPECT_EQ(patchCorrelation(from, from, {90, 70}, {90, 70}, 3), -1) << "no such level";
  EXPECT_EQ(patchCorrelation(from, from, {90, 70}, {195, 70}, 0), -1) << "beyond the border";
  // 7 pixels fit at level 0, and at level 2 no longer.
  EXPECT_NE(patchCorrelation(from, from, {20, 70}, {20, 70}, 0), -1);
  EXPECT_EQ(patchCorrelation(from, from, {20, 70}, {20, 70}, 2), -1);
}

}  // namespace
}  // namespace plumbline
