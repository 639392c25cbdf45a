// SPDX-License-Identifier: BSD-3-Clause
// The parts of the detector that know the grid but no pixels.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/target/division_distortion.h"
#include "calibrator/target/local_map.h"
#include "calibrator/target/quad_finder.h"
#include "calibrator/target/tag_sets.h"
#include "tests/calibrator/target/rendered_grid.h"

namespace plumbline {
namespace {

using test::lookAt;
using test::TestCamera;

TagImage tagSeenBy(const AprilGrid& grid, const TestCamera& camera, int id) {
  TagImage tag{.id = id};
  for (std::size_t k = 0; k < 4; ++k) {
    tag.uv[k] = camera.project(grid.corner(4 * id + static_cast<int>(k))).value();
    tag.located[k] = true;
  }
  return tag;
}

std::vector<TagImage> allTags(const AprilGrid& grid, const TestCamera& camera) {
  std::vector<TagImage> tags;
  for (int id = 0; id < grid.tagCount(); ++id) tags.push_back(tagSeenBy(grid, camera, id));
  return tags;
}

TestCamera straightCamera() {
  TestCamera camera = lookAt({0.32, 0.32}, 0.9, 0.4, -0.3, 0.5);
  camera.k1 = camera.k2 = 0;
  return camera;
}

TEST(GridTags, TagsOfOneGridAgreeInSpiteOfDistortion) {
  const AprilGrid grid;
  const auto sets = consistentSets(grid, allTags(grid, lookAt({0.32, 0.32}, 0.7, 0.5, 0.2, 1.0)));
  ASSERT_EQ(sets.size(), 1u);
  EXPECT_EQ(sets[0].size(), 36u);
}

TEST(GridTags, MisreadMirroredAndDoubledTagsAreLeftOut) {
  const AprilGrid grid;
  const TestCamera camera = lookAt({0.32, 0.32}, 0.9, 0.2, 0.2, 0.1);
  std::vector<TagImage> tags = allTags(grid, camera);
  tags[20].id = 3;                          // a second tag 3, far from its place
  std::swap(tags[7].uv[0], tags[7].uv[1]);  // runs the other way round
  std::swap(tags[7].uv[2], tags[7].uv[3]);
  std::rotate(tags[9].uv.begin(), tags[9].uv.begin() + 1, tags[9].uv.end());  // turned
  TagImage foreign = tags[0];
  foreign.id = 36;  // no tag of this grid
  tags.push_back(foreign);
  const auto sets = consistentSets(grid, tags);
  ASSERT_GE(sets.size(), 1u);
  EXPECT_EQ(sets[0].size(), 33u);
  int previous = -1;
  for (const TagImage& tag : sets[0]) {
    EXPECT_GT(tag.id, previous);
    previous = tag.id;
    EXPECT_TRUE(tag.id != 7 && tag.id != 9 && tag.id != 20 && tag.id != 36);
    EXPECT_EQ(tag.uv[0], tagSeenBy(grid, camera, tag.id).uv[0]);
  }
}

TEST(GridTags, LoneTagsAreSetsOfOne) {
  const AprilGrid grid;
  const TestCamera camera = straightCamera();
  const auto sets = consistentSets(grid, {tagSeenBy(grid, camera, 0), tagSeenBy(grid, camera, 35)});
  ASSERT_EQ(sets.size(), 2u);
  EXPECT_EQ(sets[0][0].id, 0);
  EXPECT_EQ(sets[1][0].id, 35);
  EXPECT_TRUE(consistentSets(grid, {}).empty());
}

TEST(GridTags, CrossRatioGivesTheSpacingUnderAnyPerspective) {
  const AprilGrid printed{.spacing = 0.217};
  const auto spacing = apparentSpacing(AprilGrid{}, allTags(printed, straightCamera()));
  ASSERT_TRUE(spacing.has_value());
  EXPECT_NEAR(*spacing, 0.217, 1e-9);
  EXPECT_FALSE(apparentSpacing(printed, {tagSeenBy(printed, straightCamera(), 4)}).has_value());
}

TEST(DivisionDistortion, DistortUndoesStraighten) {
  for (const double lambda : {-1.2, -0.3, 0.0, 0.2}) {
    const DivisionDistortion distortion{{376, 240}, 446, {lambda, 0, 0}};
    for (const Eigen::Vector2d& uv :
         {Eigen::Vector2d(376, 240), Eigen::Vector2d(30, 400), Eigen::Vector2d(600, 10)}) {
      EXPECT_LT((distortion.distort(distortion.straighten(uv)) - uv).norm(), 1e-9) << lambda;
    }
  }
}

TEST(DivisionDistortion, IsRecoveredFromTheGridsLines) {
  const AprilGrid grid;
  TestCamera camera = straightCamera();
  for (const double lambda : {-0.8, -0.2, 0.0, 0.15}) {
    const DivisionDistortion truth{{375.5, 239.5}, 0.5 * std::hypot(752, 480), {lambda, 0, 0}};
    std::vector<TagImage> tags = allTags(grid, camera);
    for (TagImage& tag : tags) {
      for (Eigen::Vector2d& uv : tag.uv) uv = truth.distort(uv);
    }
    EXPECT_NEAR(estimateDistortion(grid, tags, {752, 480}).terms[0], lambda, 2e-3);
  }
  EXPECT_EQ(estimateDistortion(grid, {tagSeenBy(grid, camera, 0)}, {752, 480}).terms[0], 0);
}

/// Of the corners on the lower edges of the bottom row: distance of the middle one from the line
/// through the ends, straightened [px].
double bendingOfBottomLine(const AprilGrid& grid, const TestCamera& camera,
                           const DivisionDistortion& distortion) {
  const auto straight = [&](int corner) {
    return distortion.straighten(*camera.project(grid.corner(corner)));
  };
  const Eigen::Vector2d first = straight(0), middle = straight(4 * 2 + 1),
                        last = straight(4 * 5 + 1);
  const Eigen::Vector2d along = (last - first).normalized();
  return std::abs(along.x() * (middle - first).y() - along.y() * (middle - first).x());
}

// One term leaves a third of a pixel of this lens, which is none of the division model.
TEST(DivisionDistortion, ThreeTermsStraightenAnotherLensToHundredths) {
  const AprilGrid grid;
  TestCamera camera = lookAt({0.32, 0.32}, 0.62, 0.05, 0.1, 0.02);
  const std::vector<TagImage> tags = allTags(grid, camera);
  const DivisionDistortion one = estimateDistortion(grid, tags, {752, 480});
  const DivisionDistortion three = refineDistortion(grid, tags, one);
  EXPECT_GT(bendingOfBottomLine(grid, camera, one), 0.2);
  EXPECT_LT(bendingOfBottomLine(grid, camera, three), 0.02);
}

TEST(DivisionDistortion, IsNotRefinedFromFewTags) {
  const AprilGrid grid;
  std::vector<TagImage> tags;
  for (const int id : {0, 1, 6, 7}) tags.push_back(tagSeenBy(grid, straightCamera(), id));
  tags[1].uv[2] += Eigen::Vector2d(0.2, -0.1);
  const DivisionDistortion start = estimateDistortion(grid, tags, {752, 480});
  EXPECT_TRUE(refineDistortion(grid, tags, start).terms.isZero());
}

TEST(DivisionDistortion, JacobianIsThatOfDifferences) {
  const DivisionDistortion distortion{{376, 240}, 446, {-0.4, 0.1, 0.05}};
  const Eigen::Vector2d uv(600, 60);
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d step = 1e-3 * Eigen::Vector2d::Unit(axis);
    const Eigen::Vector2d difference =
        (distortion.straighten(uv + step) - distortion.straighten(uv - step)) / 2e-3;
    EXPECT_LT((distortion.jacobian(uv).col(axis) - difference).norm(), 1e-9);
  }
}

// Tags in a diagonal: no two of them share a line.
TEST(DivisionDistortion, IsNoneWithoutALineOfFourCorners) {
  const AprilGrid grid;
  std::vector<TagImage> tags;
  for (const int id : {0, 7, 14, 21, 28}) tags.push_back(tagSeenBy(grid, straightCamera(), id));
  EXPECT_EQ(estimateDistortion(grid, tags, {752, 480}).terms[0], 0);
}

// A stereographic fisheye that sees the grid up to 87 degrees off its axis.
TEST(DivisionDistortion, KeepsItsDomainWithWideFisheyes) {
  const AprilGrid grid;
  const Eigen::Vector2d centre(255.5, 255.5);
  std::vector<TagImage> tags;
  double furthest = 0;
  for (int id = 0; id < grid.tagCount(); ++id) {
    TagImage tag{.id = id};
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::Vector2d p =
          grid.corner(4 * id + static_cast<int>(k)).head<2>() - Eigen::Vector2d(0.2, 0.2);
      tag.uv[k] = centre + 330 * std::tan(std::atan2(p.norm(), 0.03) / 2) * p.normalized();
      tag.located[k] = true;
      furthest = std::max(furthest, (tag.uv[k] - centre).norm());
    }
    tags.push_back(tag);
  }
  const DivisionDistortion found = estimateDistortion(grid, tags, {512, 512});
  EXPECT_LT(found.terms[0], -1);
  EXPECT_GT(1 + found.terms[0] * std::pow(furthest / found.radius, 2), 0);
}

TEST(LocalMap, IsExactForPerspectiveAlone) {
  const AprilGrid grid;
  const TestCamera camera = straightCamera();
  const std::vector<TagImage> few = {tagSeenBy(grid, camera, 7), tagSeenBy(grid, camera, 8)};
  const LocalMap map(grid, few, {752, 480});  // two tags: no distortion is assumed
  for (const int corner : {4 * 1 + 2, 4 * 14, 4 * 9 + 3}) {
    const auto uv = map.predict(corner, -1);
    ASSERT_TRUE(uv.has_value());
    EXPECT_LT((*uv - camera.project(grid.corner(corner)).value()).norm(), 1e-6);
  }
}

TEST(LocalMap, PredictsEveryTagFromTheOthersThroughDistortion) {
  const AprilGrid grid;
  const TestCamera camera = lookAt({0.32, 0.32}, 0.65, 0.3, 0.2, 0.3);
  const LocalMap map(grid, allTags(grid, camera), {752, 480});
  for (int id = 0; id < grid.cornerCount(); ++id) {
    const auto uv = map.predict(id, id / 4);
    ASSERT_TRUE(uv.has_value());
    EXPECT_LT((*uv - camera.project(grid.corner(id)).value()).norm(), 1.5) << "corner " << id;
  }
}

TEST(LocalMap, SaysNothingWithoutTagsWithinReach) {
  const AprilGrid grid;
  const LocalMap map(grid, {tagSeenBy(grid, straightCamera(), 0)}, {752, 480});
  EXPECT_FALSE(map.predict(4 * 35, -1).has_value());
  EXPECT_FALSE(map.predict(0, 0).has_value());
  EXPECT_TRUE(map.predict(4 * 1, -1).has_value());
}

TEST(QuadFinder, DilationTakesTheBrightestOfTheNeighbours) {
  GrayImage image(5, 4, 10);
  image.at(2, 2) = 200;
  GrayImage out;
  dilate(image.view(), 2, out);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 5; ++x) {
      EXPECT_EQ(out.at(x, y), (x == 1 || x == 2) && (y == 1 || y == 2) ? 200 : 10);
    }
  }
  dilate(image.view(), 3, out);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 5; ++x) {
      EXPECT_EQ(out.at(x, y), x >= 1 && x <= 3 && y >= 1 && y <= 3 ? 200 : 10);
    }
  }
}

}  // namespace
}  // namespace plumbline
