// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/image.h"

namespace plumbline {

/// An image and its halves: level k has pixel (x, y) where level 0 has (2^k x, 2^k y). Each level
/// is the one below, smoothed by (1 4 6 4 1)/16 along both axes and thinned.
class ImagePyramid {
 public:
  ImagePyramid() = default;
  /// `levels` >= 1; fewer where the image becomes smaller than 16 pixels.
  ImagePyramid(const GrayImageView& image, int levels);

  bool empty() const { return levels_.empty(); }
  int levels() const { return static_cast<int>(levels_.size()); }
  GrayImageView level(int k) const { return levels_[static_cast<std::size_t>(k)].view(); }

 private:
  std::vector<GrayImage> levels_;
};

}  // namespace plumbline
