// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/printed_board.h"

#include "calibrator/dense/decompositions.h"
#include "calibrator/target/tag_family.h"

namespace plumbline {

// The corners' displacements are a quadratic's values, so that least squares finds it exactly. A
// grid too small to tell some of its terms (one tag) has none of them: the shortest solution.
BoardSurface::BoardSurface(const AprilGrid& board)
    : centre_(static_cast<float>(0.5 * board.width()), static_cast<float>(0.5 * board.height())),
      unit_(centre_.norm()) {
  AprilGrid printed = board;
  // Only what is printed: tag_edge is how a detector errs.
  printed.shape.terms[kTargetTerms - 1] = 0;
  printed.shape.higher.reset();
  printed.shape.corners.reset();  // of a detector, not printed
  const std::vector<Eigen::Vector3d> points = cornerPoints(printed);
  const Eigen::Vector2d centre(0.5 * board.width(), 0.5 * board.height());
  Eigen::MatrixXd monomials(board.cornerCount(), 6), displacements(board.cornerCount(), 3);
  for (int id = 0; id < board.cornerCount(); ++id) {
    const Eigen::Vector2d p = board.corner(id), at = (p - centre) / centre.norm();
    monomials.row(id) << 1, at.x(), at.y(), at.x() * at.x(), at.x() * at.y(), at.y() * at.y();
    displacements.row(id) = points[id].transpose();
    displacements.row(id).head<2>() -= p.transpose();
  }
  const auto fitted = [&](const Eigen::MatrixXd& terms) {
    const Eigen::MatrixXd found = leastSquares(terms, displacements);
    return Eigen::MatrixXf(found.transpose().cast<float>());
  };
  polynomial_ = fitted(monomials);
  if (!board.shape.higher) return;
  // Of degree 4 and less, so that this fit is exact as well.
  const HigherBasis basis(board);
  Eigen::MatrixXd quartics(board.cornerCount(), 15);
  for (int id = 0; id < board.cornerCount(); ++id) {
    const Eigen::Vector2d at = (board.corner(id) - centre) / centre.norm();
    quartics.row(id) = quartic(at.cast<float>()).cast<double>().transpose();
    displacements.row(id) = basis.displacement(id, *board.shape.higher).transpose();
  }
  higher_ = fitted(quartics);
}

GridPattern::GridPattern(const AprilGrid& grid, double margin_m)
    : tag_size_(grid.tag_size),
      pitch_(grid.pitch()),
      gap_(grid.spacing * grid.tag_size),
      margin_(margin_m),
      tags_per_m_(1 / grid.pitch()),
      cells_per_m_(kCells / grid.tag_size),
      cols_(grid.cols),
      rows_(grid.rows) {
  static_assert(kCells == tagCells(kKalibrBorderBits));
  const int row_count = 5 + kSteps * rows_;
  surfaces_.assign(static_cast<std::size_t>(colCount()) * static_cast<std::size_t>(row_count),
                   Surface::kWall);
  auto surface = surfaces_.begin();
  for (int row = 0; row < row_count; ++row) {
    for (int col = 0; col < colCount(); ++col, ++surface) {
      if (row == 0 || col == 0 || row == row_count - 1 || col == colCount() - 1) continue;
      // One place tells: a cell is of one surface by construction.
      const Eigen::Vector2d p(middleOf(col, cols_), middleOf(row, rows_));
      *surface = gridIsBlack(grid, p) ? Surface::kBlack : Surface::kWhite;
    }
  }
}

double GridPattern::middleOf(int index, int tags) const {
  // Index 1, the paper; the wall is passed over by the constructor.
  if (index <= 1) return -gap_ - 0.5 * margin_;
  if (index >= 3 + kSteps * tags) return pitch_ * tags + 0.5 * margin_;
  const int step = index - 3 + kSteps;  // counted from the cells of a tag -1
  const int tag = step / kSteps - 1;
  const int cell = step % kSteps;
  const double within = cell == kCells ? tag_size_ + 0.5 * gap_ : (cell + 0.5) / cells_per_m_;
  return tag * pitch_ + within;
}

std::optional<Surface> GridPattern::uniformSurface(Cell low, Cell high) const {
  const Surface first = surface(low);
  // Not worth 16 look-ups and more: a pixel that large is sampled anyway.
  if (high.col - low.col > 3 || high.row - low.row > 3) return std::nullopt;
  for (int row = low.row; row <= high.row; ++row) {
    for (int col = low.col; col <= high.col; ++col) {
      if (surface({col, row}) != first) return std::nullopt;
    }
  }
  return first;
}

}  // namespace plumbline
