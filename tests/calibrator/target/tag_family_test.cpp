// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/target/tag_family.h"

#include <bit>

#include <gtest/gtest.h>

namespace plumbline {
namespace {

std::uint64_t quarterTurn(std::uint64_t payload) {
  std::uint64_t turned = 0;
  for (int row = 0; row < 6; ++row) {
    for (int col = 0; col < 6; ++col) {
      const std::uint64_t bit = payload >> (6 * row + col) & 1;
      turned |= bit << (6 * col + (5 - row));
    }
  }
  return turned;
}

// The picture of tag 0, drawn from a photograph of a grid printed by Kalibr.
TEST(TagFamily, TagZeroLooksAsKalibrPrintsIt) {
  const char* rows_from_top[] = {"..#.#.", "#...#.", "#..###", ".#.###", "#.#..#", "###.##"};
  for (int row = 0; row < 6; ++row) {
    for (int col = 0; col < 6; ++col) {
      const bool black = rows_from_top[5 - row][col] == '#';
      EXPECT_EQ(cellIsBlack(0, col + 2, row + 2), black) << "col " << col << " row " << row;
    }
  }
}

TEST(TagFamily, BorderIsBlackOnAllSides) {
  for (const int border : {1, 2}) {
    const int n = tagCells(border);
    for (int i = 0; i < n; ++i) {
      for (int depth = 0; depth < border; ++depth) {
        EXPECT_TRUE(cellIsBlack(7, i, depth, border));
        EXPECT_TRUE(cellIsBlack(7, i, n - 1 - depth, border));
        EXPECT_TRUE(cellIsBlack(7, depth, i, border));
        EXPECT_TRUE(cellIsBlack(7, n - 1 - depth, i, border));
      }
    }
  }
}

TEST(TagFamily, BorderWidthMovesThePayloadOnly) {
  for (int row = 0; row < 6; ++row) {
    for (int col = 0; col < 6; ++col) {
      EXPECT_EQ(cellIsBlack(35, col + 1, row + 1, 1), cellIsBlack(35, col + 2, row + 2, 2));
    }
  }
}

// What makes a payload recognisable, also turned: the family's Hamming distance.
TEST(TagFamily, PayloadsDifferInElevenCellsAtLeastInEveryRotation) {
  for (int a = 0; a < 100; ++a) {
    std::uint64_t turned = tagPayload(a);
    for (int turn = 0; turn < 4; ++turn, turned = quarterTurn(turned)) {
      for (int b = 0; b < 100; ++b) {
        if (a == b && turn == 0) continue;
        EXPECT_GE(std::popcount(turned ^ tagPayload(b)), 11) << a << " " << b << " turn " << turn;
      }
    }
  }
}

TEST(TagFamily, GridHasItsTagsAtTheCornersOfTheGeometry) {
  const AprilGrid grid{.rows = 3, .cols = 4, .tag_size = 0.05, .spacing = 0.2};
  const double cell = grid.tag_size / tagCells(2);
  for (int tag = 0; tag < grid.tagCount(); ++tag) {
    const Eigen::Vector2d origin = grid.corner(4 * tag);
    for (int row = 0; row < tagCells(2); ++row) {
      for (int col = 0; col < tagCells(2); ++col) {
        const Eigen::Vector2d centre = origin + cell * Eigen::Vector2d(col + 0.5, row + 0.5);
        EXPECT_EQ(gridIsBlack(grid, centre), cellIsBlack(tag, col, row));
      }
    }
  }
}

TEST(TagFamily, GridHasASmallSquareAtEveryCornerAndWhiteGaps) {
  const AprilGrid grid{.rows = 3, .cols = 4, .tag_size = 0.05, .spacing = 0.2};
  const double half_gap = 0.5 * grid.spacing * grid.tag_size;
  const double half_tag = 0.5 * grid.tag_size;
  for (int id = 0; id < grid.cornerCount(); ++id) {
    const double sx = id % 4 == 1 || id % 4 == 2 ? 1 : -1;
    const double sy = id % 4 >= 2 ? 1 : -1;
    const Eigen::Vector2d corner = grid.corner(id);
    const Eigen::Vector2d outward(sx * half_gap, sy * half_gap);
    EXPECT_TRUE(gridIsBlack(grid, corner + outward)) << "square at corner " << id;
    EXPECT_FALSE(gridIsBlack(grid, corner + Eigen::Vector2d(-sx * half_tag, outward.y())));
    EXPECT_FALSE(gridIsBlack(grid, corner + Eigen::Vector2d(outward.x(), -sy * half_tag)));
  }
}

TEST(TagFamily, PaperAroundTheGridIsWhite) {
  const AprilGrid grid;
  const double beyond = 1.01 * grid.spacing * grid.tag_size;
  EXPECT_FALSE(gridIsBlack(grid, {-beyond, -beyond}));
  EXPECT_FALSE(gridIsBlack(grid, {grid.width() + beyond, -0.5 * beyond}));
  EXPECT_FALSE(gridIsBlack(grid, {-0.5 * beyond, grid.height() + beyond}));
  EXPECT_FALSE(gridIsBlack(grid, {100.0, -100.0}));
}

}  // namespace
}  // namespace plumbline
