// SPDX-License-Identifier: BSD-3-Clause
// The basis of a board's shape: unit displacements that hold no similarity.
#include <Eigen/Core>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/error.h"

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

TEST(HigherBasis, IsOrthogonalToAllOfDegreesNoughtToTwoAndOfUnitSize) {
  for (const AprilGrid& grid : grids()) {
    const int n = grid.cornerCount();
    const HigherBasis basis(grid);
    Eigen::MatrixXd higher(n, kHigherFunctions), lower(n, 6);
    for (int id = 0; id < n; ++id) {
      const Eigen::Vector2d p = grid.corner(id);
      higher.row(id) = basis.functions(id).transpose();
      lower.row(id) << 1, p.x(), p.y(), p.x() * p.x(), p.x() * p.y(), p.y() * p.y();
    }
    EXPECT_LT((lower.transpose() * higher).cwiseAbs().maxCoeff(), 1e-11 * n);
    const Eigen::MatrixXd gram = higher.transpose() * higher / n;
    for (int j = 0; j < kHigherFunctions; ++j) {
      for (int k = 0; k < kHigherFunctions; ++k) {
        const bool is_small = k == j && gram(j, j) == 0;  // of degree 4 on two rows of tags
        EXPECT_NEAR(gram(j, k), j == k && !is_small ? 1 : 0, 1e-11);
      }
    }
  }
  const HigherBasis large{AprilGrid()};
  EXPECT_GT(large.functions(0).cwiseAbs().minCoeff(), 0);
}

TEST(HigherBasis, AShapeIsFittedByItsOwnTerms) {
  AprilGrid board;
  board.shape.terms << 4e-4, -1e-4, 0, 2e-5, -1e-4, 0, 2e-4, 0, -3e-4, 5e-5, -1e-4, -2e-4;
  const auto displaced = [&] {
    std::vector<Eigen::Vector3d> out = cornerPoints(board);
    for (int id = 0; id < board.cornerCount(); ++id) {
      out[static_cast<std::size_t>(id)].head<2>() -= board.corner(id);
    }
    return out;
  };
  EXPECT_FALSE(fitTargetShape(AprilGrid(), displaced()).higher);
  board.shape.higher = 1e-4 * HigherTerms::LinSpaced(-1, 1);
  const TargetShape fitted = fitTargetShape(AprilGrid(), displaced());
  ASSERT_TRUE(fitted.higher);
  EXPECT_LT((*fitted.higher - *board.shape.higher).norm(), 1e-12);
  EXPECT_LT((fitted.terms - board.shape.terms).norm(), 1e-12);
  EXPECT_NEAR(fitted.rms(), board.shape.rms(), 1e-12);
}

TEST(TargetBasis, TheTagsEdgeGrowsByItsTermAtUnchangedPitch) {
  AprilGrid board;
  board.shape.terms[kTargetTerms - 1] = 1e-3;
  const auto points = cornerPoints(board);
  EXPECT_NEAR((points[1] - points[0]).norm(), board.tag_size + 1e-3, 1e-15);
  EXPECT_NEAR((points[4] - points[0]).norm(), board.pitch(), 1e-15);
}

TEST(TargetShape, RemaindersMoveTheirOwnCorners) {
  AprilGrid board;
  board.shape.corners = Eigen::VectorXd::Zero(3 * board.cornerCount());
  board.shape.corners->segment<3>(3 * 5) << 1e-3, -2e-3, 3e-3;
  EXPECT_FALSE(board.shape.isFlat());
  EXPECT_EQ(board.shape.rms(), 0);  // they are not the board's
  const auto moved = cornerPoints(board), flat = cornerPoints(AprilGrid());
  for (std::size_t id = 0; id < moved.size(); ++id) {
    const Eigen::Vector3d by =
        id == 5 ? Eigen::Vector3d(1e-3, -2e-3, 3e-3) : Eigen::Vector3d::Zero();
    EXPECT_LT((moved[id] - flat[id] - by).norm(), 1e-15);
  }
}

// A record that was edited: no vector is read past its end.
TEST(TargetShape, RemaindersOfAnotherGridAreRefused) {
  AprilGrid board;
  board.shape.corners = Eigen::VectorXd::Zero(3 * board.cornerCount() - 3);
  EXPECT_THROW((void)cornerPoints(board), InputError);
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
    EXPECT_LT((fitTargetShape(grid, moved).terms - board.shape.terms).norm(), 1e-15);
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
