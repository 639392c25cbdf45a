// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstring>

#include "calibrator/odometry/feature_tracker.h"

namespace plumbline {
namespace {

constexpr int kSmallest = 16;  // [px]: below it a patch no longer fits

/// Pixel (x, y) is centred on (2x, 2y): between levels coordinates are halved without an offset,
/// which averages of 2 x 2 pixels would bring in.
GrayImage halved(const GrayImageView& from) {
  const int width = (from.width + 1) / 2, height = (from.height + 1) / 2;
  GrayImage to(width, height);
  // One smoothed row of the full width, padded by two on either side.
  std::vector<int> row(static_cast<std::size_t>(from.width) + 4);
  for (int y = 0; y < height; ++y) {
    const auto at = [&](int dy) { return from.row(std::clamp(2 * y + dy, 0, from.height - 1)); };
    const std::uint8_t *a = at(-2), *b = at(-1), *c = at(0), *d = at(1), *e = at(2);
    int* const mid = row.data() + 2;
    for (int x = 0; x < from.width; ++x) mid[x] = a[x] + e[x] + 4 * (b[x] + d[x]) + 6 * c[x];
    mid[-1] = mid[-2] = mid[0];
    mid[from.width] = mid[from.width + 1] = mid[from.width - 1];
    std::uint8_t* out = to.row(y);
    for (int x = 0; x < width; ++x) {
      const int* m = mid + 2 * x;
      // The weights of both axes add up to 16 * 16; + 128 rounds.
      out[x] = static_cast<std::uint8_t>((m[-2] + m[2] + 4 * (m[-1] + m[1]) + 6 * m[0] + 128) >> 8);
    }
  }
  return to;
}

}  // namespace

ImagePyramid::ImagePyramid(const GrayImageView& image, int levels) {
  GrayImage base(image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    std::memcpy(base.row(y), image.row(y), static_cast<std::size_t>(image.width));
  }
  levels_.push_back(std::move(base));
  while (static_cast<int>(levels_.size()) < levels &&
         std::min(levels_.back().width(), levels_.back().height()) >= 2 * kSmallest) {
    levels_.push_back(halved(levels_.back().view()));
  }
}

}  // namespace plumbline
