// SPDX-License-Identifier: BSD-3-Clause
// The basis of a board's shape: unit displacements that hold no similarity.
#include <Eigen/Core>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/base/april_grid.h"

namespace plumbline {
namespace {

std::vector<AprilGrid> grids() {
  return {{6, 6, 0.088, 0.3, {}}, {5, 7, 0.055, 0.3, {}}, {2, 3, 0.1, 0.25, {}}};
}

Eigen::Matrix<double, Eigen::Dynamic, kTargetTerms> allColumns(const AprilGrid& grid) {
  const TargetBasis basis(grid);
  Eigen::Matrix<double, Eigen::Dynamic, kTargetTerms> B(3 * grid.cornerCount(), kTargetTerms);
  for (int id = 0; id < grid.cornerCount(); ++id) B.middleRows<3>(3 * id) = basis.columns(id);
  return B;
}

TEST(TargetBasis, EveryTermButTheTagsMovesTheCornersByItselfInTheRootMeanSquare) {
  for (const AprilGrid& grid : grids()) {
    const auto B = allColumns(grid);
    for (int j = 0; j + 1 < kTargetTerms; ++j) {
      EXPECT_NEAR(B.col(j).squaredNorm() / grid.cornerCount(), 1, 1e-12) << kTargetTermNames[j];
    }
  }
}

TEST(TargetBasis, TheBoardsTermsHoldNoSimilarity) {
  for (const AprilGrid& grid : grids()) {
    const auto B = allColumns(grid);
    const Eigen::Vector2d centre(0.5 * grid.width(), 0.5 * grid.height());
    Eigen::Matrix<double, 7, kTargetTerms - 1> dot = Eigen::Matrix<double, 7, 11>::Zero();
    for (int id = 0; id < grid.cornerCount(); ++id) {
      const Eigen::Vector2d p = grid.corner(id) - centre;
      Eigen::Matrix<double, 7, 3> similarity;
      similarity << Eigen::Matrix3d::Identity(),  //
          0, 0, p.y(), 0, 0, -p.x(),              // turns about x and y
          -p.y(), p.x(), 0,                       // about z
          p.x(), p.y(), 0;                        // scale
      dot += similarity * B.middleRows<3>(3 * id).leftCols<kTargetTerms - 1>();
    }
    EXPECT_LT(dot.cwiseAbs().maxCoeff(), 1e-11 * grid.cornerCount());
  }
}

TEST(TargetBasis, TheTagsEdgeGrowsByItsTermAtUnchangedPitch) {
  AprilGrid board;
  board.shape.terms[kTargetTerms - 1] = 1e-3;
  const auto points = cornerPoints(board);
  EXPECT_NEAR((points[1] - points[0]).norm(), board.tag_size + 1e-3, 1e-15);
  EXPECT_NEAR((points[4] - points[0]).norm(), board.pitch(), 1e-15);
}

TEST(TargetBasis, AFlatBoardIsTheGrid) {
  const AprilGrid grid;
  const auto points = cornerPoints(grid);
  for (int id = 0; id < grid.cornerCount(); ++id) {
    EXPECT_EQ(points[id].head<2>(), grid.corner(id));
    EXPECT_EQ(points[id].z(), 0);
  }
}

TEST(TargetBasis, FittedTermsAreThoseThatMovedTheCorners) {
  for (const AprilGrid& grid : grids()) {
    AprilGrid board = grid;
    for (int j = 0; j < kTargetTerms; ++j) board.shape.terms[j] = 1e-4 * (j + 1);
    auto moved = cornerPoints(board);
    const auto flat = cornerPoints(grid);
    for (std::size_t id = 0; id < moved.size(); ++id) moved[id] -= flat[id];
    EXPECT_LT((fitTargetTerms(grid, moved) - board.shape.terms).norm(), 1e-15);
  }
}

TEST(TargetBasis, ASingleTagShowsNoCurvature) {
  const AprilGrid tag{1, 1, 0.1, 0.3, {}};
  const auto observable = TargetBasis(tag).observable();
  EXPECT_TRUE(observable[0] && observable[1]);  // stretch and shear
  EXPECT_FALSE(observable[2]);                  // x, with x^2
  EXPECT_FALSE(observable[8]);                  // z, with x^2
}

}  // namespace
}  // namespace plumbline
