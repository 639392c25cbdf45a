// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "calibrator/base/image.h"
#include "calibrator/target/tag_image.h"

namespace plumbline {

/// The surroundings of a corner, as far as they belong to it: an ellipse, image of a disc of the
/// target's plane.
struct CornerWindow {
  Eigen::Vector2d start = Eigen::Vector2d::Zero();  ///< guess [px]
  /// Columns: from the corner along the two edges of the tag, away from the tag's inside, to where
  /// the corner's surroundings end (the smaller of border width and small square) [px].
  Eigen::Matrix2d axes = Eigen::Matrix2d::Identity();
  double max_shift_px = 2;  ///< the corner must lie this close to the guess
};

/// E of the window x' E^-1 x <= 1 about a corner: the disc's image, with A the axes, never thinner
/// than 2 px, so that it holds both sides of each edge:
///   E = A A' + (2 px)^2 I.
/// Its extent in u and v is the root of E's diagonal.
inline Eigen::Matrix2d ellipseOf(const Eigen::Matrix2d& axes) {
  constexpr double kMinRadius_px = 2;
  return axes * axes.transpose() + kMinRadius_px * kMinRadius_px * Eigen::Matrix2d::Identity();
}

/// Grey levels of the four sectors that the edges part.
struct SectorLevels {
  double dark[2];   ///< inside the tag, and across
  double light[2];  ///< beside it
};

/// They are read at 0.55 of the axes: clear of the blurred edges, short of the window's end.
inline SectorLevels sectorLevels(const GrayImageView& image, const Eigen::Matrix2d& axes,
                                 const Eigen::Vector2d& corner) {
  const auto level = [&](double a, double b) {
    return sampleBilinear(image, corner + 0.55 * axes * Eigen::Vector2d(a, b));
  };
  return {{level(-1, -1), level(1, 1)}, {level(1, -1), level(-1, 1)}};
}

}  // namespace plumbline
