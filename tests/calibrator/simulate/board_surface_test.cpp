// SPDX-License-Identifier: BSD-3-Clause
// The surface between a board's corners passes through them.
#include <gtest/gtest.h>

#include "calibrator/simulate/printed_board.h"

namespace plumbline {
namespace {

TEST(BoardSurface, PassesThroughTheCornersWithTermsOfEveryDegree) {
  AprilGrid board;
  board.shape.terms << 4e-4, -1e-4, 0, 2e-5, -1e-4, 0, 2e-4, 0, -3e-4, 5e-5, -1e-4, 0;
  for (const bool higher : {false, true}) {
    if (higher) board.shape.higher = 1e-4 * HigherTerms::LinSpaced(-1, 1);
    const BoardSurface surface(board);
    const auto points = cornerPoints(board);
    for (int id = 0; id < board.cornerCount(); ++id) {
      const Eigen::Vector2d grid = board.corner(id);
      Eigen::Vector3d d = points[static_cast<std::size_t>(id)];
      d.head<2>() -= grid;
      EXPECT_LT((surface.displacement(grid.cast<float>()) - d.cast<float>()).norm(), 1e-8F);
    }
  }
}

}  // namespace
}  // namespace plumbline
