// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "calibrator/base/april_grid.h"

namespace plumbline {

/// The surface of a board that is not flat and even, between its corners and on the paper around
/// them: the point (x, y) of the even grid lies at (x, y, 0) + displacement(x, y) in F.
class BoardSurface {
 public:
  /// Of the shape's terms but tag_edge, which is one of recording and detector.
  explicit BoardSurface(const AprilGrid& board);

  bool isFlat() const { return polynomial_.isZero(0); }

  /// [m], of a point of the grid's plane [m]: quadratic in X, Y, as TargetBasis is at the corners,
  /// and constant beyond 1.5 times the grid's half diagonal from its centre, along each axis.
  Eigen::Vector3f displacement(const Eigen::Vector2f& p) const {
    const Eigen::Vector2f at = ((p - centre_) / unit_).cwiseMax(-kReach).cwiseMin(kReach);
    Monomials m;
    m << 1, at.x(), at.y(), at.x() * at.x(), at.x() * at.y(), at.y() * at.y();
    return polynomial_ * m;
  }

 private:
  using Monomials = Eigen::Matrix<float, 6, 1>;
  static constexpr float kReach = 1.5F;

  Eigen::Vector2f centre_;
  float unit_;
  Eigen::Matrix<float, 3, 6> polynomial_;
};

}  // namespace plumbline
