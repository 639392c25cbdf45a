// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/QR>

#include "calibrator/base/april_grid.h"

namespace plumbline {

/// Displacements of a board's single corners, 3 n numbers, that are no similarity and none of its
/// terms (TargetBasis, HigherBasis): the orthogonal complement of those over the corners, in the
/// plane and in height. Its basis are the last columns of the Q of their QR decompositions; a
/// remainder is given by its coordinates there [m], those in the plane first. So the terms keep
/// their meaning beside it, and scale and place of the board their own.
class RemainderSpace {
 public:
  static constexpr int kMostCoordinates = 800;  // a board of 8 x 8 tags has 722
  explicit RemainderSpace(const AprilGrid& board);

  int plane() const { return static_cast<int>(plane_.rows() - plane_.rank()); }
  int height() const { return static_cast<int>(height_.rows() - height_.rank()); }
  int size() const { return plane() + height(); }
  /// Whether there are remainders in the plane and in height, and not more than the dense systems
  /// of their estimation are meant for, which cost the cube of size().
  bool isUsable() const { return plane() > 0 && height() > 0 && size() <= kMostCoordinates; }

  /// Products with x, y of corner 0, of corner 1, ..., then with all heights (3 n rows) become
  /// those with the coordinates (size() rows).
  Eigen::MatrixXd reduced(const Eigen::Ref<const Eigen::MatrixXd>& rows) const;

  /// x, y, height of corner 0, of corner 1, ... from coordinates, and back.
  Eigen::VectorXd corners(const Eigen::VectorXd& coordinates) const;
  Eigen::VectorXd coordinates(const Eigen::VectorXd& corners) const;

 private:
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> plane_, height_;
};

}  // namespace plumbline
