// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/residuals/packed_corners.h"

#include <algorithm>
#include <cassert>
#include <numeric>

namespace plumbline {
namespace {

constexpr int kColumns = 7;  // x y z u v w edge

int lines(int count) { return (count + kLanes - 1) / kLanes; }

/// tagEdgeScale() of every tag, one view after the other in the same memory.
class EdgeScales {
 public:
  explicit EdgeScales(const AprilGrid& target)
      : at_(target.cornerCount()), scales_(at_.size() / 4) {}

  /// By the mean length of the tag's edges that the view has; of tags without an edge by the mean
  /// of the others.
  const std::vector<double>& of(const ImageView& view) {
    std::fill(at_.begin(), at_.end(), nullptr);
    for (const Corner& corner : view.corners) {
      assert(corner.id >= 0 && static_cast<std::size_t>(corner.id) < at_.size());
      at_[corner.id] = &corner.uv;
    }
    double sum = 0;
    int seen = 0;
    for (std::size_t tag = 0; tag < scales_.size(); ++tag) {
      const double edge = scales_[tag] = edgeOf(tag);
      sum += edge;
      seen += edge > 0 ? 1 : 0;
    }
    const double mean = seen > 0 ? sum / seen : kTagEdgePx;
    for (double& scale : scales_) scale = tagEdgeScale(scale > 0 ? scale : mean);
    return scales_;
  }

 private:
  /// Mean length of a tag's edges [px]; 0 where the view has none.
  double edgeOf(std::size_t tag) const {
    double sum = 0;
    int count = 0;
    // A tag's corners go round it, so that k and k + 1 share an edge.
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::Vector2d* a = at_[4 * tag + k];
      const Eigen::Vector2d* b = at_[4 * tag + (k + 1) % 4];
      if (a == nullptr || b == nullptr) continue;
      sum += (*a - *b).norm();
      ++count;
    }
    return count > 0 ? sum / count : 0;
  }

  std::vector<const Eigen::Vector2d*> at_;  // by corner_id; null: not seen
  std::vector<double> scales_;
};

}  // namespace

double PackedView::used() const { return std::accumulate(w, w + count, 0.); }

PlacedBoard::PlacedBoard(AprilGrid board) : tag_edge_(board.shape.terms[kTargetTerms - 1]) {
  board.shape.terms[kTargetTerms - 1] = 0;
  points_ = cornerPoints(board);
}

/// Moved outward by half of what the tag seems wider: corners 1 and 2 lie to the right, 2 and 3 at
/// the top.
Eigen::Vector3d PlacedBoard::point(int corner_id, double edge_scale) const {
  constexpr double kRight[] = {-1, 1, 1, -1};
  constexpr double kUp[] = {-1, -1, 1, 1};
  const double half = 0.5 * tag_edge_ * edge_scale;
  Eigen::Vector3d p = points_[corner_id];
  p.x() += half * kRight[corner_id % 4];
  p.y() += half * kUp[corner_id % 4];
  return p;
}

PackedCorners::PackedCorners(const AprilGrid& target, const std::vector<ImageView>& views) {
  for (const ImageView& view : views) {
    offset_.push_back(static_cast<int>(total_));
    count_.push_back(static_cast<int>(view.corners.size()));
    total_ += lines(count_.back());
  }
  const PlacedBoard board(target);
  EdgeScales edge_scales(target);
  storage_.resize(kColumns * total_);
  ids_.resize(kLanes * total_);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::vector<Corner>& corners = views[i].corners;
    const int n = count_[i];
    const int step = lines(n);
    const std::vector<double>& scales = edge_scales.of(views[i]);
    // Lanes beyond the last corner repeat it with weight 0: kernels need no masks, and a corner
    // that is there projects to finite numbers, where zeros might divide by zero.
    for (int j = 0; j < kLanes * step; ++j) {
      const Corner& corner = corners[std::min(j, n - 1)];
      const double scale = scales[corner.id / 4];
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

PackedCorners PackedCorners::thinned(const std::vector<int>& views, int most) const {
  assert(most >= 1);
  PackedCorners out;
  for (const int v : views) {
    out.offset_.push_back(static_cast<int>(out.total_));
    out.count_.push_back(std::min(count_[v], most));
    out.total_ += lines(out.count_.back());
  }
  out.storage_.resize(kColumns * out.total_);
  out.ids_.resize(kLanes * out.total_);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const int n = out.count_[i], all = count_[views[i]];
    const Line* from = storage_.data() + kColumns * offset_[views[i]];
    Line* to = out.storage_.data() + kColumns * out.offset_[i];
    for (int j = 0; j < kLanes * lines(n); ++j) {
      const int k = std::min(j, n - 1) * all / n;
      for (int c = 0; c < kColumns; ++c) {
        to[c * lines(n) + j / kLanes].lane[j % kLanes] =
            from[c * lines(all) + k / kLanes].lane[k % kLanes];
      }
      if (j >= n) to[5 * lines(n) + j / kLanes].lane[j % kLanes] = 0;
      out.ids_[kLanes * out.offset_[i] + j] = ids_[kLanes * offset_[views[i]] + k];
    }
  }
  return out;
}

void PackedCorners::place(const AprilGrid& target) {
  const PlacedBoard board(target);
  for (std::size_t i = 0; i < count_.size(); ++i) {
    const int step = lines(count_[i]);
    Line* line = storage_.data() + kColumns * offset_[i];
    const int* id = ids_.data() + kLanes * offset_[i];
    for (int j = 0; j < kLanes * step; ++j) {
      // By the edges as they were measured: another board does not change how large the image shows
      // a tag.
      const double scale = line[j / kLanes + 6 * step].lane[j % kLanes];
      const Eigen::Vector3d p = board.point(id[j], scale);
      for (int axis = 0; axis < 3; ++axis) {
        line[j / kLanes + axis * step].lane[j % kLanes] = p[axis];
      }
    }
  }
}

void PackedCorners::displace(const std::function<Eigen::Vector2d(double, double)>& displacement) {
  for (std::size_t i = 0; i < count_.size(); ++i) {
    const int step = lines(count_[i]);
    Line* line = storage_.data() + kColumns * offset_[i];
    for (int j = 0; j < kLanes * step; ++j) {
      double& u = line[j / kLanes + 3 * step].lane[j % kLanes];
      double& v = line[j / kLanes + 4 * step].lane[j % kLanes];
      const Eigen::Vector2d d = displacement(u, v);
      u += d.x();
      v += d.y();
    }
  }
}

void PackedCorners::setWeight(int view, int position, double weight) {
  assert(view >= 0 && view < viewCount() && position >= 0 && position < count_[view]);
  // The kernels count a weight for its own square (gram_kernel.h), which is true of 0 and 1 alone.
  assert(weight == 0 || weight == 1);
  Line* line = storage_.data() + kColumns * offset_[view] + 5 * lines(count_[view]);
  line[position / kLanes].lane[position % kLanes] = weight;
}

}  // namespace plumbline
