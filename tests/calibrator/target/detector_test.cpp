// SPDX-License-Identifier: BSD-3-Clause
// What these tests do not prove: that real paper, lenses and light look like the rendered ones; see
// detector_real_test.cpp for photographs.
#include "calibrator/target/detector.h"

#include <cmath>
#include <ostream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/target/grid_search.h"
#include "tests/calibrator/target/rendered_grid.h"

namespace plumbline {
namespace {

using test::lookAt;
using test::renderClutter;
using test::renderGrid;
using test::RenderOptions;
using test::TestCamera;
using ::testing::HasSubstr;

/// How a detection compares with the truth of a rendered image.
struct Score {
  int visible_tags = 0;   ///< all four corners at least 4 px inside the image
  int complete_tags = 0;  ///< of those, found with four corners
  int false_corners = 0;  ///< more than 1 px off
  int corners = 0;
  double squared_error = 0;
  Eigen::Vector2d error_sum = Eigen::Vector2d::Zero();

  double rms() const { return std::sqrt(squared_error / corners); }
  Eigen::Vector2d bias() const { return error_sum / corners; }
};

bool insideBy(const TestCamera& camera, const std::optional<Eigen::Vector2d>& uv, double margin) {
  return uv && uv->x() >= margin && uv->y() >= margin && uv->x() <= camera.width - 1 - margin &&
         uv->y() <= camera.height - 1 - margin;
}

bool fullyVisible(const AprilGrid& grid, const TestCamera& camera, int tag) {
  for (int k = 0; k < 4; ++k) {
    if (!insideBy(camera, camera.project(grid.corner(4 * tag + k)), 4.01)) return false;
  }
  return true;
}

void addScore(Score& score, const AprilGrid& grid, const TestCamera& camera,
              const Detection& detection) {
  std::vector<int> corners_of(static_cast<std::size_t>(grid.tagCount()), 0);
  for (const DetectedTag& tag : detection.tags) {
    corners_of[static_cast<std::size_t>(tag.id)] = tag.corners;
  }
  for (int tag = 0; tag < grid.tagCount(); ++tag) {
    if (!fullyVisible(grid, camera, tag)) continue;
    ++score.visible_tags;
    if (corners_of[static_cast<std::size_t>(tag)] == 4) ++score.complete_tags;
  }
  for (const Corner& corner : detection.corners) {
    const std::optional<Eigen::Vector2d> truth = camera.project(grid.corner(corner.id));
    if (!truth || !((corner.uv - *truth).norm() <= 1)) {
      ++score.false_corners;
      continue;
    }
    ++score.corners;
    score.squared_error += (corner.uv - *truth).squaredNorm();
    score.error_sum += corner.uv - *truth;
  }
}

/// Views as a calibration has them: near and far, tilted, rolled, parts of the grid outside.
std::vector<TestCamera> variedViews() {
  return {lookAt({0.32, 0.32}, 1.00, 0.0, 0.0, 0.0),   lookAt({0.32, 0.32}, 0.75, 0.6, 0.1, 0.4),
          lookAt({0.20, 0.45}, 0.90, -0.5, 0.5, -1.2), lookAt({0.10, 0.10}, 1.30, 0.2, -0.6, 2.8),
          lookAt({0.50, 0.20}, 0.65, -0.3, 0.4, 1.6),  lookAt({0.32, 0.32}, 1.50, 0.4, 0.4, 0.78)};
}

Score scoreOfVariedViews(double blur_px, double noise_gray) {
  const AprilGrid grid;
  const AprilGridDetector detector(grid);
  Score score;
  std::uint32_t seed = 1;
  for (const TestCamera& camera : variedViews()) {
    const GrayImage image =
        renderGrid(grid, camera, {.blur_px = blur_px, .noise_gray = noise_gray, .seed = seed++});
    addScore(score, grid, camera, detector.detect(image.view()));
  }
  return score;
}

TEST(Detector, FindsRenderedTagsToHundredthsOfAPixel) {
  const Score score = scoreOfVariedViews(0.8, 4);
  EXPECT_GE(score.visible_tags, 150);
  EXPECT_GE(score.complete_tags, 0.99 * score.visible_tags);
  EXPECT_EQ(score.false_corners, 0);
  EXPECT_LE(score.rms(), 0.045);
}

TEST(Detector, ReadsADarkImageDownToTheContrastAskedFor) {
  const AprilGrid grid;
  const TestCamera camera = lookAt({0.32, 0.32}, 0.9, 0.2, 0.2, 0.1);
  const RenderOptions dark{.noise_gray = 1, .white = 30, .black = 10};
  const GrayImage image = renderGrid(grid, camera, dark);
  EXPECT_EQ(AprilGridDetector(grid).detect(image.view()).tags.size(), 36u);
  EXPECT_TRUE(AprilGridDetector(grid, {.min_contrast = 60}).detect(image.view()).tags.empty());
}

// Beside a tag that is known, as the library reads it in a dark image.
TEST(GridSearch, ReadsTagsDownToTheContrastAskedFor) {
  const AprilGrid grid;
  const TestCamera camera = lookAt({0.32, 0.32}, 0.9, 0.2, 0.2, 0.1);
  const GrayImage image = renderGrid(grid, camera, {.noise_gray = 0, .white = 18, .black = 9});
  for (const int contrast : {5, 12}) {
    CornerRefiner refiner;
    GridSearch search(grid, {.min_contrast = contrast}, image.view(), refiner);
    std::vector<TagImage> known;
    for (const int id : {0, 1, 6, 7}) {
      TagImage tag{.id = id};
      for (std::size_t k = 0; k < 4; ++k) {
        tag.uv[k] = *camera.project(grid.corner(4 * id + static_cast<int>(k)));
      }
      search.refineCorners(tag);
      known.push_back(tag);
    }
    search.start(known);
    search.grow();
    EXPECT_EQ(search.tags().size() > 30, contrast == 5) << search.tags().size();
  }
}

// Half a pixel of origin, or the dilation's shift, would stand out here.
TEST(Detector, PixelCentresAreAtIntegersWithoutBias) {
  const Score score = scoreOfVariedViews(0.7, 0);
  EXPECT_LE(score.rms(), 0.03);
  EXPECT_LT(std::abs(score.bias().x()), 0.003);
  EXPECT_LT(std::abs(score.bias().y()), 0.003);
}

TEST(Detector, CornersAreUniqueAscendingAndNumberedByTheGrid) {
  const AprilGrid grid;
  const TestCamera camera = lookAt({0.32, 0.32}, 1.0, 0.3, 0.2, 0.1);
  const Detection detection = AprilGridDetector(grid).detect(renderGrid(grid, camera).view());
  ASSERT_EQ(detection.tags.size(), 36u);
  ASSERT_EQ(detection.corners.size(), 144u);
  for (std::size_t i = 0; i < 144; ++i) {
    EXPECT_EQ(detection.corners[i].id, static_cast<int>(i));
  }
  ASSERT_TRUE(detection.spacing.has_value());
  EXPECT_NEAR(*detection.spacing, grid.spacing, 0.005);
}

TEST(Detector, ReadsBothBorderWidths) {
  const AprilGrid grid;
  const TestCamera camera = lookAt({0.32, 0.32}, 0.9, 0.2, 0.2, 0.1);
  for (const int printed : {1, 2}) {
    const GrayImage image = renderGrid(grid, camera, {.border_bits = printed});
    const Detection detection =
        AprilGridDetector(grid, {.border_bits = printed}).detect(image.view());
    EXPECT_EQ(detection.tags.size(), 36u) << "border of " << printed;
  }
}

TEST(Detector, FindsNoThinBorderWhereAThickOneIsExpected) {
  const AprilGrid grid;
  const GrayImage image =
      renderGrid(grid, lookAt({0.32, 0.32}, 0.9, 0.2, 0.2, 0.1), {.border_bits = 1});
  EXPECT_TRUE(AprilGridDetector(grid, {.border_bits = 2}).detect(image.view()).tags.empty());
}

TEST(Detector, DropsCornersNearTheEdgeOfTheImageAndKeepsTheRestOfTheTag) {
  const AprilGrid grid;
  const TestCamera camera = lookAt({0.05, 0.3}, 0.7, 0.1, 0.1, 0.02);
  const GrayImage image = renderGrid(grid, camera);
  const Detection wide =
      AprilGridDetector(grid, {.min_border_distance_px = 0}).detect(image.view());
  const Detection narrow =
      AprilGridDetector(grid, {.min_border_distance_px = 40}).detect(image.view());
  EXPECT_GT(wide.corners.size(), narrow.corners.size());
  EXPECT_GE(narrow.tags.size(), 4u);
  for (const Corner& corner : narrow.corners) {
    EXPECT_TRUE(insideBy(camera, corner.uv, 40)) << corner.uv.transpose();
  }
  bool some_tag_is_cut = false;
  for (const DetectedTag& tag : narrow.tags) some_tag_is_cut |= tag.corners < 4;
  EXPECT_TRUE(some_tag_is_cut);
}

TEST(Detector, DropsTagsWithShorterEdgesThanAskedFor) {
  const AprilGrid grid;
  const GrayImage image = renderGrid(grid, lookAt({0.32, 0.32}, 1.0, 0.3, 0.2, 0.1));
  EXPECT_EQ(AprilGridDetector(grid, {.min_edge_px = 20}).detect(image.view()).tags.size(), 36u);
  EXPECT_TRUE(AprilGridDetector(grid, {.min_edge_px = 80}).detect(image.view()).tags.empty());
}

TEST(Detector, ReportsNothingWhereThereIsNoGrid) {
  const AprilGridDetector detector(AprilGrid{});
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    const RenderOptions clutter{.noise_gray = seed % 2 == 0 ? 4.0 : 60.0, .seed = seed};
    EXPECT_TRUE(detector.detect(renderClutter(752, 480, clutter).view()).corners.empty());
  }
  EXPECT_TRUE(detector.detect(GrayImage(752, 480, 128).view()).corners.empty());
  EXPECT_TRUE(detector.detect(GrayImage(3, 2, 0).view()).corners.empty());
  EXPECT_TRUE(detector.detect(GrayImageView{}).corners.empty());
}

// The tags are those of the grid sought, in other places.
TEST(Detector, RefusesAGridOfAnotherLayout) {
  const AprilGrid printed{.rows = 5, .cols = 7};
  const TestCamera camera = lookAt({0.37, 0.27}, 0.95, 0.2, 0.2, 0.1);
  const GrayImage image = renderGrid(printed, camera);
  ASSERT_EQ(AprilGridDetector(printed).detect(image.view()).tags.size(), 35u);
  const Detection other = AprilGridDetector(AprilGrid{.rows = 6, .cols = 6}).detect(image.view());
  EXPECT_TRUE(other.corners.empty());
  EXPECT_GT(other.rejected_tags, 15);
}

// One tag stands elsewhere as well: it contradicts the grid, not the grid it.
TEST(Detector, WhatContradictsTheLargestSetIsToldWhereNoneIsAccepted) {
  const AprilGrid grid;
  const TestCamera camera = lookAt({0.50, 0.32}, 1.2, 0, 0, 0);
  GrayImage image = renderGrid(grid, camera, {.noise_gray = 0});
  const Eigen::Vector2d a = *camera.project(grid.corner(4 * 14) - Eigen::Vector2d(0.02, 0.02));
  const Eigen::Vector2d b = *camera.project(grid.corner(4 * 14 + 2) + Eigen::Vector2d(0.02, 0.02));
  const int left = static_cast<int>(a.x()), top = static_cast<int>(b.y());
  const int width = static_cast<int>(b.x()) - left, height = static_cast<int>(a.y()) - top;
  for (int y = -10; y < height + 10; ++y) {
    for (int x = -10; x < width + 10; ++x) {
      const bool inside = x >= 0 && y >= 0 && x < width && y < height;
      image.at(640 + x, 200 + y) = inside ? image.at(left + x, top + y) : std::uint8_t{200};
    }
  }
  const Detection found = AprilGridDetector(grid).detect(image.view());
  EXPECT_EQ(found.tags.size(), 36u);
  EXPECT_EQ(found.rejected_tags, 1);
  const Detection refused = AprilGridDetector(grid, {.min_tags = 37}).detect(image.view());
  EXPECT_TRUE(refused.tags.empty());
  EXPECT_LE(refused.rejected_tags, 2);  // squares of both dilations count
}

TEST(Detector, RefusesAMirroredGrid) {
  const AprilGrid grid;
  const GrayImage image = renderGrid(grid, lookAt({0.32, 0.32}, 0.9, 0.2, 0.2, 0.1));
  GrayImage mirrored(image.width(), image.height());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) mirrored.at(image.width() - 1 - x, y) = image.at(x, y);
  }
  EXPECT_TRUE(AprilGridDetector(grid).detect(mirrored.view()).corners.empty());
}

// What a wrong tagSpacing in the target file looks like to the user.
TEST(Detector, MeasuresTheSpacingThatIsPrinted) {
  const AprilGrid printed{.spacing = 0.25};
  const GrayImage image = renderGrid(printed, lookAt({0.3, 0.3}, 0.9, 0.3, 0.2, 0.1));
  const Detection detection = AprilGridDetector(AprilGrid{.spacing = 0.3}).detect(image.view());
  ASSERT_TRUE(detection.spacing.has_value());
  EXPECT_NEAR(*detection.spacing, 0.25, 0.005);
}

TEST(Detector, RowsMayBePaddedAndTheDetectorIsReusable) {
  const AprilGrid grid;
  const GrayImage image = renderGrid(grid, lookAt({0.3, 0.3}, 1.0, 0.3, 0.2, 0.1));
  const int stride = image.width() + 24;
  std::vector<std::uint8_t> padded(static_cast<std::size_t>(stride * image.height()), 255);
  for (int y = 0; y < image.height(); ++y) {
    std::copy(image.row(y), image.row(y) + image.width(),
              padded.begin() + static_cast<std::ptrdiff_t>(y) * stride);
  }
  const AprilGridDetector detector(grid);
  const Detection first = detector.detect(image.view());
  detector.detect(renderClutter(320, 200).view());
  const Detection second = detector.detect({padded.data(), image.width(), image.height(), stride});
  ASSERT_EQ(first.corners.size(), second.corners.size());
  for (std::size_t i = 0; i < first.corners.size(); ++i) {
    EXPECT_EQ(first.corners[i].id, second.corners[i].id);
    EXPECT_EQ(first.corners[i].uv, second.corners[i].uv);
  }
}

TEST(Detector, NamesTheOptionThatIsOutOfRange) {
  const auto message = [](const AprilGrid& grid, const DetectorOptions& options) {
    try {
      const AprilGridDetector detector(grid, options);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(message({}, {.border_bits = 3}), HasSubstr("border_bits is 3"));
  EXPECT_THAT(message({}, {.decimation = 0.5}), HasSubstr("decimation is 0.5"));
  EXPECT_THAT(message({}, {.max_hamming = 3}), HasSubstr("max_hamming is 3"));
  EXPECT_THAT(message({}, {.min_border_distance_px = -1}), HasSubstr("min_border_distance_px"));
  EXPECT_THAT(message({}, {.min_edge_px = 1}), HasSubstr("min_edge_px"));
  EXPECT_THAT(message({}, {.max_grid_error_px = NAN}), HasSubstr("max_grid_error_px"));
  EXPECT_THAT(message({}, {.min_contrast = 0}), HasSubstr("min_contrast is 0"));
  EXPECT_THAT(message({}, {.min_tags = 1}), HasSubstr("min_tags is 1"));
  EXPECT_THAT(message({.rows = 30, .cols = 20}, {}), HasSubstr("30 x 20 tags"));
  EXPECT_EQ(message({}, {}), "accepted");
}

}  // namespace
}  // namespace plumbline
