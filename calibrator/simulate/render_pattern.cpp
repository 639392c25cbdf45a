// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/render_pattern.h"

#include "calibrator/target/tag_family.h"

namespace plumbline {

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
      const Eigen::Vector2d p(middleOf(col, cols_), middleOf(row, rows_));
      *surface = gridIsBlack(grid, p) ? Surface::kBlack : Surface::kWhite;
    }
  }
}

double GridPattern::middleOf(int index, int tags) const {
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
  if (high.col - low.col > 3 || high.row - low.row > 3) return std::nullopt;
  for (int row = low.row; row <= high.row; ++row) {
    for (int col = low.col; col <= high.col; ++col) {
      if (surface({col, row}) != first) return std::nullopt;
    }
  }
  return first;
}

}  // namespace plumbline
