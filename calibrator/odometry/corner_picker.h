// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrator/base/image.h"

namespace plumbline {

struct CornerPickerOptions {
  int cell_px = 40;             ///< one corner a cell
  double min_distance_px = 20;  ///< from what is tracked already
  float min_eigenvalue = 20;    ///< of the mean squared gradient about it [grey levels^2/px^2]

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// New points to track: in each cell of the image without one of `taken`, the pixel with the
/// greatest smaller eigenvalue of the gradient's second moments over 7 x 7 pixels, if that is large
/// enough. At least 12 pixels from the border. Those with the greatest eigenvalue first.
/// Source: Shi and Tomasi, "Good features to track", CVPR 1994.
std::vector<Eigen::Vector2f> pickCorners(const GrayImageView& image,
                                         const std::vector<Eigen::Vector2f>& taken,
                                         const CornerPickerOptions& options);

}  // namespace plumbline
