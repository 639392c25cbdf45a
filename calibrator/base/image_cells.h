// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "calibrator/base/session.h"

namespace plumbline {

/// A grid of equal cells over an image, numbered row by row from the top left.
struct ImageCells {
  int columns = 8, rows = 6;

  int size() const { return columns * rows; }
  /// The cell that holds a pixel (the first pixel's centre is (0, 0)); beside the image the
  /// nearest.
  int cellOf(const Eigen::Vector2d& uv, const Resolution& image) const {
    const auto place = [](double x, int pixels, int cells) {
      return std::clamp(static_cast<int>((x + 0.5) * cells / pixels), 0, cells - 1);
    };
    return place(uv.y(), image.height, rows) * columns + place(uv.x(), image.width, columns);
  }
};

/// Whether a pixel is part of the image.
inline bool isInImage(const Eigen::Vector2d& uv, const Resolution& image) {
  return uv.x() >= -0.5 && uv.x() < image.width - 0.5 && uv.y() >= -0.5 &&
         uv.y() < image.height - 0.5;
}

}  // namespace plumbline
