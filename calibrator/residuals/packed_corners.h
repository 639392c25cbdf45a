// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/session.h"

namespace plumbline {

/// Lanes to which a view is padded; padding repeats the last corner with weight 0.
inline constexpr int kLanes = 8;

/// One view's corners as structure of arrays; pointers into a PackedCorners, valid while it lives.
struct PackedView {
  int count = 0;              ///< corners
  int padded = 0;             ///< count rounded up to kLanes
  const double* x = nullptr;  ///< target coordinates in F, the board's shape included [m]
  const double* y = nullptr;
  const double* z = nullptr;
  const double* u = nullptr;  ///< measured pixels
  const double* v = nullptr;
  const double* edge = nullptr;  ///< tagEdgeScale() of the corner's tag, as measured
  const double* w = nullptr;     ///< weight: 1 used, 0 rejected or padding
  const int* id = nullptr;       ///< corner_id

  double used() const;  ///< corners with weight: their sum
};

/// Corners of a board as seen by a detector that does not widen the tags, and by how much it does:
/// that differs from view to view with the size at which a tag is seen.
class PlacedBoard {
 public:
  explicit PlacedBoard(AprilGrid board);
  /// Place of a corner where tagEdgeScale() is `edge_scale` [m].
  Eigen::Vector3d point(int corner_id, double edge_scale) const;

 private:
  std::vector<Eigen::Vector3d> points_;
  double tag_edge_;
};

/// All views of one camera in one block of memory, 64-byte aligned at every view.
class PackedCorners {
 public:
  PackedCorners() = default;
  PackedCorners(const AprilGrid& target, const std::vector<ImageView>& views);

  int viewCount() const { return static_cast<int>(count_.size()); }
  PackedView view(int index) const;
  /// Copies of some views, with at most `most` corners of each, evenly in their order.
  PackedCorners thinned(const std::vector<int>& views, int most) const;
  /// Moves the corners of all views onto a board of the same grid, its shape included.
  void place(const AprilGrid& board);
  /// Adds displacement(u, v) [px] to every measured pixel.
  void displace(const std::function<Eigen::Vector2d(double, double)>& displacement);
  /// Sets the weight of one corner (position within its view): 0 rejects it, 1 uses it; nothing
  /// between.
  void setWeight(int view, int position, double weight);

 private:
  // One cache line of doubles: the unit of the arena, so that every copy stays aligned.
  struct alignas(64) Line {
    double lane[kLanes] = {};
  };
  // Per view the columns x y z u v w edge, each padded to whole lines; offsets count lines of one
  // column.
  std::vector<Line> storage_;
  std::vector<int> ids_;
  std::vector<int> offset_;
  std::vector<int> count_;
  std::size_t total_ = 0;
};

}  // namespace plumbline
