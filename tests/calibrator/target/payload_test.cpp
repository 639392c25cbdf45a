// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/LU>

#include <gtest/gtest.h>

#include "calibrator/target/tag_family.h"
#include "calibrator/target/tag_image.h"

namespace plumbline {
namespace {

const TagCorners kQuad = {Eigen::Vector2d(20.3, 71.2), Eigen::Vector2d(75.1, 78.4),
                          Eigen::Vector2d(82.0, 22.7), Eigen::Vector2d(25.5, 15.1)};

constexpr double kLeastContrast = 12;

/// A tag drawn pixel by pixel in the quad on white paper, brightness falling to the right; cells in
/// `flipped` (bits as in tagPayload) are printed wrong.
GrayImage drawTag(const TagCorners& quad, int id, std::uint64_t flipped, double light_fall = 0) {
  const Eigen::Matrix3d to_tag = squareToQuad(quad).inverse();
  GrayImage image(100, 100);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) {
      const Eigen::Vector2d at = 10 * mapPoint(to_tag, x, y);
      const int col = static_cast<int>(std::floor(at.x()));
      const int row = static_cast<int>(std::floor(at.y()));
      bool black = col >= 0 && row >= 0 && col < 10 && row < 10 && cellIsBlack(id, col, row);
      if (col >= 2 && row >= 2 && col < 8 && row < 8) {
        black ^= (flipped >> (6 * (row - 2) + col - 2) & 1) != 0;
      }
      image.at(x, y) = static_cast<std::uint8_t>((black ? 40 : 220) * (1 - light_fall * x / 100.0));
    }
  }
  return image;
}

TEST(Payload, SquareToQuadMapsTheFourCorners) {
  const Eigen::Matrix3d H = squareToQuad(kQuad);
  EXPECT_LT((mapPoint(H, 0, 0) - kQuad[0]).norm(), 1e-12);
  EXPECT_LT((mapPoint(H, 1, 0) - kQuad[1]).norm(), 1e-12);
  EXPECT_LT((mapPoint(H, 1, 1) - kQuad[2]).norm(), 1e-12);
  EXPECT_LT((mapPoint(H, 0, 1) - kQuad[3]).norm(), 1e-12);
}

TEST(Payload, SquareToQuadKeepsTheCrossingOfTheDiagonals) {
  const Eigen::Vector2d centre = mapPoint(squareToQuad(kQuad), 0.5, 0.5);
  for (const std::size_t k : {0u, 1u}) {
    const Eigen::Vector2d along = (kQuad[k + 2] - kQuad[k]).normalized();
    const Eigen::Vector2d to = centre - kQuad[k];
    EXPECT_NEAR(along.x() * to.y() - along.y() * to.x(), 0, 1e-12);
  }
}

TEST(Payload, BilinearSamplesAreExactOnAPlaneAndClampedOutside) {
  GrayImage image(6, 5);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 6; ++x) image.at(x, y) = static_cast<std::uint8_t>(10 + 7 * x + 11 * y);
  }
  EXPECT_DOUBLE_EQ(sampleBilinear(image.view(), {2.25, 3.5}), 10 + 7 * 2.25 + 11 * 3.5);
  EXPECT_DOUBLE_EQ(sampleBilinear(image.view(), {5, 4}), 10 + 35 + 44);
  EXPECT_DOUBLE_EQ(sampleBilinear(image.view(), {-3, 9}), 10 + 44);
}

TEST(Payload, CountsTheCellsThatDiffer) {
  const TagImage tag{.id = 11, .uv = kQuad};
  EXPECT_EQ(payloadDistance(drawTag(kQuad, 11, 0).view(), tag, 2, kLeastContrast), 0);
  EXPECT_EQ(payloadDistance(drawTag(kQuad, 11, 1).view(), tag, 2, kLeastContrast), 1);
  EXPECT_EQ(payloadDistance(drawTag(kQuad, 11, 0b100000010001).view(), tag, 2, kLeastContrast), 3);
}

TEST(Payload, AnotherTagOrATurnedOneIsFarAway) {
  TagImage tag{.id = 12, .uv = kQuad};
  EXPECT_GE(payloadDistance(drawTag(kQuad, 11, 0).view(), tag, 2, kLeastContrast).value(), 9);
  tag.id = 11;
  std::rotate(tag.uv.begin(), tag.uv.begin() + 1, tag.uv.end());
  EXPECT_GE(payloadDistance(drawTag(kQuad, 11, 0).view(), tag, 2, kLeastContrast).value(), 9);
}

TEST(Payload, UnevenLightDoesNotMatter) {
  const TagImage tag{.id = 11, .uv = kQuad};
  EXPECT_EQ(payloadDistance(drawTag(kQuad, 11, 0, 0.85).view(), tag, 2, kLeastContrast), 0);
}

TEST(Payload, NothingIsReadWithoutContrastOrOutsideTheImage) {
  TagImage tag{.id = 11, .uv = kQuad};
  EXPECT_FALSE(
      payloadDistance(GrayImage(100, 100, 120).view(), tag, 2, kLeastContrast).has_value());
  for (Eigen::Vector2d& uv : tag.uv) uv.x() += 60;
  EXPECT_FALSE(payloadDistance(drawTag(kQuad, 11, 0).view(), tag, 2, kLeastContrast).has_value());
}

}  // namespace
}  // namespace plumbline
