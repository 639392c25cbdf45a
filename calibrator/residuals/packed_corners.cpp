// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/residuals/packed_corners.h"

#include <cassert>

namespace plumbline {
namespace {

constexpr int kColumns = 7;  // x y z u v w edge

int lines(int count) { return (count + kLanes - 1) / kLanes; }

/// Mean length of the edges of every tag that the view has; 0 where it has no edge.
std::vector<double> edgesOf(const AprilGrid& target, const ImageView& view) {
  const auto corners = static_cast<std::size_t>(target.cornerCount());
  std::vector<const Eigen::Vector2d*> at(corners, nullptr);
  for (const Corner& corner : view.corners) {
    assert(corner.id >= 0 && corner.id < target.cornerCount());
    at[static_cast<std::size_t>(corner.id)] = &corner.uv;
  }
  std::vector<double> edges(corners / 4, 0.0);
  for (std::size_t tag = 0; tag < edges.size(); ++tag) {
    double sum = 0;
    int count = 0;
    // A tag's corners go round it, so that k and k + 1 share an edge.
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::Vector2d* a = at[4 * tag + k];
      const Eigen::Vector2d* b = at[4 * tag + (k + 1) % 4];
      if (a == nullptr || b == nullptr) continue;
      sum += (*a - *b).norm();
      ++count;
    }
    if (count > 0) edges[tag] = sum / count;
  }
  return edges;
}

/// tagEdgeScale() of every tag of a view; of tags without an edge that of the others' mean.
std::vector<double> edgeScales(const AprilGrid& target, const ImageView& view) {
  std::vector<double> scales = edgesOf(target, view);
  double sum = 0, seen = 0;
  for (const double edge : scales) {
    sum += edge;
    seen += edge > 0 ? 1 : 0;
  }
  const double mean = seen > 0 ? sum / seen : kTagEdgePx;
  for (double& scale : scales) scale = tagEdgeScale(scale > 0 ? scale : mean);
  return scales;
}

/// Corners of a board as seen by a detector that does not widen the tags, and by how much it does:
/// that differs from view to view with the size at which a tag is seen.
struct PlacedBoard {
  explicit PlacedBoard(AprilGrid board) : tag_edge(board.shape.terms[kTargetTerms - 1]) {
    board.shape.terms[kTargetTerms - 1] = 0;
    points = cornerPoints(board);
  }
  /// Corner `id` moved outward by half of what the tag seems wider: 1 and 2 lie to the right, 2 and
  /// 3 at the top.
  Eigen::Vector3d point(int id, double edge_scale) const {
    const int k = id % 4;
    const double half = 0.5 * tag_edge * edge_scale;
    Eigen::Vector3d p = points[static_cast<std::size_t>(id)];
    p.x() += k == 1 || k == 2 ? half : -half;
    p.y() += k == 2 || k == 3 ? half : -half;
    return p;
  }
  std::vector<Eigen::Vector3d> points;
  double tag_edge;
};

}  // namespace

PackedCorners::PackedCorners(const AprilGrid& target, const std::vector<ImageView>& views) {
  for (const ImageView& view : views) {
    offset_.push_back(static_cast<int>(total_));
    count_.push_back(static_cast<int>(view.corners.size()));
    total_ += lines(count_.back());
  }
  const PlacedBoard board(target);
  storage_.resize(kColumns * total_);
  ids_.resize(kLanes * total_);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const int n = count_[i];
    const int step = lines(n);
    const std::vector<double> scales = edgeScales(target, views[i]);
    // Lanes beyond the last corner repeat it with weight 0: kernels need no masks, and a corner
    // that is there projects to finite numbers, where zeros might divide by zero.
    for (int j = 0; j < kLanes * step; ++j) {
      const Corner& corner = views[i].corners[j < n ? j : n - 1];
      assert(corner.id >= 0 && corner.id < target.cornerCount());
      const double scale = scales[static_cast<std::size_t>(corner.id) / 4];
      const Eigen::Vector3d p_F = board.point(corner.id, scale);
      const double row[kColumns] = {p_F.x(),       p_F.y(),         p_F.z(), corner.uv.x(),
                                    corner.uv.y(), j < n ? 1. : 0., scale};
      Line* line = storage_.data() + kColumns * offset_[i] + j / kLanes;
      for (int c = 0; c < kColumns; ++c) line[c * step].lane[j % kLanes] = row[c];
      ids_[kLanes * offset_[i] + j] = corner.id;
    }
  }
}

PackedView PackedCorners::view(int index) const {
  assert(index >= 0 && index < viewCount());
  PackedView view;
  view.count = count_[index];
  view.padded = kLanes * lines(view.count);
  if (view.count == 0) return view;
  const Line* line = storage_.data() + kColumns * offset_[index];
  const int step = lines(view.count);
  view.x = line->lane;
  view.y = line[step].lane;
  view.z = line[2 * step].lane;
  view.u = line[3 * step].lane;
  view.v = line[4 * step].lane;
  view.w = line[5 * step].lane;
  view.edge = line[6 * step].lane;
  view.id = ids_.data() + kLanes * offset_[index];
  return view;
}

void PackedCorners::place(const AprilGrid& target) {
  const PlacedBoard board(target);
  for (std::size_t i = 0; i < count_.size(); ++i) {
    const int step = lines(count_[i]);
    Line* line = storage_.data() + kColumns * offset_[i];
    const int* id = ids_.data() + kLanes * offset_[i];
    for (int j = 0; j < kLanes * step; ++j) {
      const double scale = line[j / kLanes + 6 * step].lane[j % kLanes];
      const Eigen::Vector3d p = board.point(id[j], scale);
      for (int axis = 0; axis < 3; ++axis) {
        line[j / kLanes + axis * step].lane[j % kLanes] = p[axis];
      }
    }
  }
}

void PackedCorners::setWeight(int view, int position, double weight) {
  assert(view >= 0 && view < viewCount() && position >= 0 && position < count_[view]);
  assert(weight == 0 || weight == 1);
  Line* line = storage_.data() + kColumns * offset_[view] + 5 * lines(count_[view]);
  line[position / kLanes].lane[position % kLanes] = weight;
}

}  // namespace plumbline
