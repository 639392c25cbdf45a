// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/render_pattern.h"

#include <algorithm>

#include "calibrator/target/tag_family.h"

namespace plumbline {

// Along one axis with n tags the indices are: 0 wall, 1 paper, 2 the gap before tag 0, then for
// every tag its cells and the gap after it, and at the end paper and wall again.

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

int GridPattern::indexOf(double x_m, int tags) const {
  const double end = pitch_ * tags;
  if (x_m < -gap_) return x_m < -gap_ - margin_ ? 0 : 1;
  if (x_m < 0) return 2;
  if (x_m >= end) return (x_m < end + margin_ ? 3 : 4) + kSteps * tags;
  const int tag = static_cast<int>(x_m * tags_per_m_);
  return 3 + kSteps * tag + std::min(static_cast<int>((x_m - tag * pitch_) * cells_per_m_), kCells);
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
