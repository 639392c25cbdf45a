// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

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

}  // namespace plumbline
