// SPDX-License-Identifier: BSD-3-Clause
// What single corners do beside a similarity and the board's terms.
#include <gtest/gtest.h>

#include "calibrator/batch/board/higher_terms.h"

namespace plumbline {
namespace {

TEST(RemainderSpace, HoldsNoTermAndNoSimilarity) {
  for (const AprilGrid& grid : {AprilGrid(), AprilGrid{3, 5, 0.05, 0.2, {}}}) {
    const RemainderSpace space(grid);
    AprilGrid board = grid;
    board.shape.terms = 1e-3 * TargetTerms::LinSpaced(1, 2);
    board.shape.higher = 1e-3 * HigherTerms::LinSpaced(-1, 2);
    const auto points = cornerPoints(board);
    Eigen::VectorXd moved(3 * grid.cornerCount());
    for (int id = 0; id < grid.cornerCount(); ++id) {
      const Eigen::Vector2d p = grid.corner(id);
      moved.segment<3>(3 * id) = points[static_cast<std::size_t>(id)];
      // Turned about the normal, wider, moved, and tilted; small.
      moved.segment<3>(3 * id) +=
          1e-3 *
          Eigen::Vector3d(2 - p.y() + 3 * p.x(), 1 + p.x() + 3 * p.y(), 1 + 2 * p.x() - p.y());
    }
    EXPECT_LT(space.coordinates(moved).norm(), 1e-12);
  }
}

TEST(RemainderSpace, CoordinatesAreThoseOfTheCornersThatTheyMake) {
  const RemainderSpace space{AprilGrid()};
  EXPECT_EQ(space.plane(), 2 * 144 - 4 - 9 - 18);  // similarity, degree 2 and tag_edge, higher
  EXPECT_EQ(space.height(), 144 - 3 - 3 - 9);
  const Eigen::VectorXd x = Eigen::VectorXd::Random(space.size());
  const Eigen::VectorXd corners = space.corners(x);
  EXPECT_LT((space.coordinates(corners) - x).norm(), 1e-12);
  EXPECT_NEAR(corners.norm(), x.norm(),
              1e-12);  // orthonormal: a coordinate's variance is a corner's
  // Those in the plane have no height.
  Eigen::VectorXd plane = x;
  plane.tail(space.height()).setZero();
  const Eigen::VectorXd flat = space.corners(plane);
  for (int id = 0; id < 144; ++id) EXPECT_EQ(flat[3 * id + 2], 0);
}

// Its corners can do what a similarity, stretch, shear and the products X Y do, and no more.
TEST(RemainderSpace, ASingleTagHasNone) {
  EXPECT_EQ(RemainderSpace(AprilGrid{1, 1, 0.1, 0.3, {}}).size(), 0);
}

TEST(RemainderSpace, IsForBoardsNeitherTooSmallNorTooLarge) {
  const auto usable = [](int rows, int cols) {
    return RemainderSpace(AprilGrid{rows, cols, 0.05, 0.3, {}}).isUsable();
  };
  EXPECT_FALSE(usable(1, 1) || usable(1, 2));
  EXPECT_TRUE(usable(3, 3) && usable(6, 6) && usable(8, 8));
  EXPECT_FALSE(usable(9, 9));
}

}  // namespace
}  // namespace plumbline
