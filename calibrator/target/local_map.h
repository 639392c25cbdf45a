// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/target/division_distortion.h"
#include "calibrator/target/tag_image.h"

namespace plumbline {

/// Where a place on the grid lies in the image, told by the tags around it: a homography from the
/// grid to the straightened image (DivisionDistortion), fitted to the corners near the place with
/// weights that fall with the distance on the grid. What the one-parameter distortion leaves over
/// is smooth, so that the local fit takes it up.
class LocalMap {
 public:
  /// From the located corners of `tags`, whose lines also give the distortion.
  LocalMap(const AprilGrid& grid, const std::vector<TagImage>& tags, const Resolution& resolution);

  /// Image of corner `corner_id` as predicted without the corners of tag `left_out` (-1: none)
  /// [px]. Empty where the corners within reach do not fix a homography.
  std::optional<Eigen::Vector2d> predict(int corner_id, int left_out) const;

 private:
  struct Point {
    int tag_id, row, col;
    Eigen::Vector2d on_grid;   ///< in F, in units of the pitch
    Eigen::Vector2d straight;  ///< relative to the distortion's centre, in units of its radius
  };
  AprilGrid grid_;
  DivisionDistortion distortion_;
  std::vector<Point> points_;
};

}  // namespace plumbline
