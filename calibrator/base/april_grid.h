// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cassert>
#include <vector>

#include "calibrator/base/target_shape.h"

namespace plumbline {

/// Geometry of Kalibr's AprilGrid in its own frame F: z = 0 plane, x right along a row of tags, y
/// up, origin at the bottom-left corner of tag 0. Tags run along x first; the corners of a tag are
/// 0 bottom-left, 1 bottom-right, 2 top-right, 3 top-left; corner_id = 4 * tag_id + corner.
struct AprilGrid {
  int rows = 6;             ///< tags along y
  int cols = 6;             ///< tags along x
  double tag_size = 0.088;  ///< outer edge of a tag's black border [m]
  double spacing = 0.3;     ///< gap between tags as a ratio of tag_size [-]
  TargetShape shape;        ///< how the board departs from the grid, as far as it is known

  double pitch() const { return tag_size * (1 + spacing); }  ///< tag to tag [m]
  int tagCount() const { return rows * cols; }
  int cornerCount() const { return 4 * tagCount(); }
  double width() const { return pitch() * (cols - 1) + tag_size; }   ///< along x [m]
  double height() const { return pitch() * (rows - 1) + tag_size; }  ///< along y [m]

  /// Position of a corner in F on the even grid [m], whatever the shape (with it: cornerPoints());
  /// 0 <= corner_id < cornerCount().
  Eigen::Vector2d corner(int corner_id) const {
    assert(corner_id >= 0 && corner_id < cornerCount());
    const int tag = corner_id / 4;
    const int k = corner_id % 4;
    const int row = tag / cols;
    Eigen::Vector2d p(pitch() * (tag % cols), pitch() * row);
    if (k == 1 || k == 2) p.x() += tag_size;
    if (k == 2 || k == 3) p.y() += tag_size;
    return p;
  }
};

/// All corners of a board in F [m], by corner_id, tag_edge at tagEdgeScale() 1.
std::vector<Eigen::Vector3d> cornerPoints(const AprilGrid& board);

}  // namespace plumbline
