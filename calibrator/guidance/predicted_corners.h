// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstring>
#include <vector>

#include "calibrator/residuals/packed_corners.h"

namespace plumbline {

/// Where the four corners of a tag are seen [px].
struct TagImage {
  double u[4], v[4];
};

/// Corners that a camera would see, in memory that the next view uses again.
class PredictedCorners {
 public:
  /// Takes up to `most` corners.
  explicit PredictedCorners(int most);
  void clear() { count_ = 0; }
  /// The corners first, first + 1 ... of a tag, at (x, y) of F [m] (four of each).
  void add(int first, const double* x, const double* y, const TagImage& seen) {
    double* row = columns_.data() + count_;
    std::memcpy(row, x, sizeof seen.u);
    std::memcpy(row + stride_, y, sizeof seen.u);
    std::memcpy(row + 2 * stride_, seen.u, sizeof seen.u);
    std::memcpy(row + 3 * stride_, seen.v, sizeof seen.v);
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
      row[4 * stride_ + i] = 1;
      ids_[static_cast<std::size_t>(count_ + i)] = first + i;
    }
    count_ += 4;
  }
  /// All that was added, each with weight 1; valid until the next change.
  PackedView view();

 private:
  int stride_;
  int count_ = 0;
  std::vector<double> columns_;  // x y u v w
  std::vector<int> ids_;
};

}  // namespace plumbline
