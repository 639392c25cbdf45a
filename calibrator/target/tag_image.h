// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>

#include "calibrator/target/detector.h"

namespace plumbline {

/// Corners of a tag in an image in Kalibr's order (bottom-left, bottom-right, top-right, top-left
/// of the upright tag) [px].
using TagCorners = std::array<Eigen::Vector2d, 4>;

/// A tag in an image while it is being worked on.
struct TagImage {
  int id = 0;
  TagSource source = TagSource::kLibrary;
  int hamming = 0;
  TagCorners uv = {};
  std::array<bool, 4> located = {};  ///< refined and not refused since
};

/// Length of the shortest and of the longest edge [px].
inline double shortestEdge(const TagCorners& uv) {
  double least = (uv[0] - uv[3]).norm();
  for (std::size_t k = 0; k < 3; ++k) least = std::min(least, (uv[k + 1] - uv[k]).norm());
  return least;
}

/// Twice the area, positive if the corners run counter-clockwise as a viewer in front of the target
/// sees them (v runs down) [px^2].
inline double signedDoubleArea(const TagCorners& uv) {
  const Eigen::Vector2d a = uv[2] - uv[0];
  const Eigen::Vector2d b = uv[3] - uv[1];
  return a.y() * b.x() - a.x() * b.y();
}

}  // namespace plumbline
