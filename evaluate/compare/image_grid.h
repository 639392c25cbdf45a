// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "calibrator/base/session.h"

namespace plumbline {

/// Points spread over an image, row-major from the top left, the first and last of each row and
/// column on its border: u = c (width - 1) / (columns - 1), v alike. Odd counts have the centre.
struct ImageGrid {
  int columns = 31, rows = 21;  ///< each at least 2

  int size() const { return columns * rows; }
  Eigen::Vector2d pixel(const Resolution& image, int index) const {
    const int column = index % columns;
    const int row = index / columns;
    return {column * (image.width - 1.0) / (columns - 1), row * (image.height - 1.0) / (rows - 1)};
  }
};

}  // namespace plumbline
