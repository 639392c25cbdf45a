// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/predicted_corners.h"

namespace plumbline {

PredictedCorners::PredictedCorners(int most)
    : stride_((most + kLanes - 1) / kLanes * kLanes),
      columns_(static_cast<std::size_t>(5 * stride_)),
      ids_(static_cast<std::size_t>(stride_)) {}

PackedView PredictedCorners::view() {
  PackedView view;
  view.count = count_;
  view.padded = (count_ + kLanes - 1) / kLanes * kLanes;
  double* all = columns_.data();
  for (int i = count_; i < view.padded; ++i) {
    for (int column = 0; column < 4; ++column) {
      all[column * stride_ + i] = all[column * stride_ + count_ - 1];
    }
    all[4 * stride_ + i] = 0;
  }
  view.x = all;
  view.y = all + stride_;
  view.u = all + 2 * stride_;
  view.v = all + 3 * stride_;
  view.w = all + 4 * stride_;
  view.id = ids_.data();
  return view;
}

}  // namespace plumbline
