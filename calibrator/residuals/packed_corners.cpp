// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/residuals/packed_corners.h"

#include <cassert>

namespace plumbline {
namespace {

constexpr int kColumns = 6;  // x y z u v w

int lines(int count) { return (count + kLanes - 1) / kLanes; }

}  // namespace

PackedCorners::PackedCorners(const AprilGrid& target, const std::vector<ImageView>& views) {
  for (const ImageView& view : views) {
    offset_.push_back(static_cast<int>(total_));
    count_.push_back(static_cast<int>(view.corners.size()));
    total_ += lines(count_.back());
  }
  const std::vector<Eigen::Vector3d> points = cornerPoints(target);
  storage_.resize(kColumns * total_);
  ids_.resize(kLanes * total_);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const int n = count_[i];
    const int step = lines(n);
    // Lanes beyond the last corner repeat it with weight 0: kernels need no masks, and a corner
    // that is there projects to finite numbers, where zeros might divide by zero.
    for (int j = 0; j < kLanes * step; ++j) {
      const Corner& corner = views[i].corners[j < n ? j : n - 1];
      assert(corner.id >= 0 && corner.id < target.cornerCount());
      const Eigen::Vector3d& p_F = points[static_cast<std::size_t>(corner.id)];
      const double row[kColumns] = {p_F.x(),       p_F.y(),       p_F.z(),
                                    corner.uv.x(), corner.uv.y(), j < n ? 1. : 0.};
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
  view.id = ids_.data() + kLanes * offset_[index];
  return view;
}

void PackedCorners::place(const std::vector<Eigen::Vector3d>& points) {
  for (std::size_t i = 0; i < count_.size(); ++i) {
    const int step = lines(count_[i]);
    Line* line = storage_.data() + kColumns * offset_[i];
    const int* id = ids_.data() + kLanes * offset_[i];
    for (int j = 0; j < kLanes * step; ++j) {
      const Eigen::Vector3d& p = points[static_cast<std::size_t>(id[j])];
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
