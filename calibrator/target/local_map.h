// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/target/tag_image.h"

namespace plumbline {

/// Where a place on the grid lies in the image, told by the tags around it: a homography fitted to
/// their corners with weights that fall with the distance on the grid, so that lens distortion,
/// which no homography can follow over the whole grid, hardly matters.
class LocalMap {
 public:
  explicit LocalMap(const AprilGrid& grid) : grid_(grid) {}

  /// Image of corner `corner_id` predicted from the located corners of `tags`, those of tag
  /// `left_out` excepted (-1: none) [px]. Empty where fewer than two tags are at hand or their
  /// corners do not fix a homography.
  std::optional<Eigen::Vector2d> predict(const std::vector<TagImage>& tags, int corner_id,
                                         int left_out) const;

 private:
  AprilGrid grid_;
};

}  // namespace plumbline
