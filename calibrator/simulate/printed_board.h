// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "calibrator/base/april_grid.h"

namespace plumbline {

/// The surface of a board that is not flat and even, between its corners and on the paper around
/// them: the point (x, y) of the even grid lies at (x, y, 0) + displacement(x, y) in F.
class BoardSurface {
 public:
  /// Of the shape's terms but tag_edge, which is one of recording and detector.
  explicit BoardSurface(const AprilGrid& board);

  bool isFlat() const { return polynomial_.isZero(0) && !higher_; }

  /// [m], of a point of the grid's plane [m]: quadratic in X, Y, as TargetBasis is at the corners,
  /// or of degree 4 where the board has such terms; and constant beyond 1.5 times the grid's half
  /// diagonal from its centre, along each axis.
  Eigen::Vector3f displacement(const Eigen::Vector2f& p) const {
    const Eigen::Vector2f at = ((p - centre_) / unit_).cwiseMax(-kReach).cwiseMin(kReach);
    Monomials m;
    m << 1, at.x(), at.y(), at.x() * at.x(), at.x() * at.y(), at.y() * at.y();
    if (!higher_) return polynomial_ * m;
    return polynomial_ * m + *higher_ * quartic(at);
  }

 private:
  using Monomials = Eigen::Matrix<float, 6, 1>;
  using Quartic = Eigen::Matrix<float, 15, 1>;
  static constexpr float kReach = 1.5F;

  /// All monomials of degrees 0 to 4.
  static Quartic quartic(const Eigen::Vector2f& at) {
    const float x = at.x(), y = at.y(), xx = x * x, yy = y * y;
    Quartic m;
    m << 1, x, y, xx, x * y, yy, xx * x, xx * y, x * yy, y * yy, xx * xx, xx * x * y, xx * yy,
        x * yy * y, yy * yy;
    return m;
  }

  Eigen::Vector2f centre_;
  float unit_;
  Eigen::Matrix<float, 3, 6> polynomial_;
  std::optional<Eigen::Matrix<float, 3, 15>> higher_;
};

/// What a point of the target's plane is covered with.
enum class Surface : std::uint8_t { kWall, kWhite, kBlack };

/// A printed AprilGrid on a sheet of white paper on a wall: the plane z = 0 of F divided into
/// rectangles of one surface each, so that "is this patch uniform?" needs no sampling.
class GridPattern {
 public:
  /// Index of the rectangle that a point lies in.
  struct Cell {
    int col = 0, row = 0;
  };

  /// `margin_m`: paper around the outermost corner squares. grid.tagCount() <= kFamilySize
  /// (calibrator/target/tag_family.h).
  GridPattern(const AprilGrid& grid, double margin_m);

  Cell cellAt(double x_m, double y_m) const { return {indexOf(x_m, cols_), indexOf(y_m, rows_)}; }
  Surface surface(Cell cell) const {
    return surfaces_[static_cast<std::size_t>(cell.row) * static_cast<std::size_t>(colCount()) +
                     static_cast<std::size_t>(cell.col)];
  }
  /// The one surface of all cells from `low` to `high`, both included; empty where they differ.
  std::optional<Surface> uniformSurface(Cell low, Cell high) const;

 private:
  int colCount() const { return 5 + kSteps * cols_; }

  // Along one axis with n tags the indices are: 0 wall, 1 paper, 2 the gap before tag 0, then for
  // every tag its cells and the gap after it, and at the end paper and wall again. Defined here
  // so that it is inlined: rendering calls it for every ray.
  int indexOf(double x_m, int tags) const {
    const double end = pitch_ * tags;
    if (x_m < -gap_) return x_m < -gap_ - margin_ ? 0 : 1;
    if (x_m < 0) return 2;
    if (x_m >= end) return (x_m < end + margin_ ? 3 : 4) + kSteps * tags;
    const int tag = static_cast<int>(x_m * tags_per_m_);
    const int cell = static_cast<int>((x_m - tag * pitch_) * cells_per_m_);
    return 3 + kSteps * tag + std::min(cell, kCells);
  }
  double middleOf(int index, int tags) const;

  static constexpr int kCells = 10;          // along a tag, border included
  static constexpr int kSteps = kCells + 1;  // ... and the gap after it

  double tag_size_, pitch_, gap_, margin_;
  double tags_per_m_, cells_per_m_;
  int cols_, rows_;
  std::vector<Surface> surfaces_;
};

}  // namespace plumbline
