// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/target/tag_image.h"

namespace plumbline {

/// The division model of lens distortion (A. Fitzgibbon, CVPR 2001), one parameter about a known
/// centre: with d = (uv - centre) / radius,
///   straight = centre + radius * d / (1 + lambda |d|^2),
/// so that straight lines of the world are straight lines of `straight`. lambda < 0 is barrel
/// distortion. Good to a few pixels for any lens, which is enough to tell where a tag is.
struct DivisionDistortion {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< [px]
  double radius = 1;                                 ///< [px], sets the scale of lambda
  double lambda = 0;

  /// Of a pixel with 1 + lambda |d|^2 > 0.
  Eigen::Vector2d straighten(const Eigen::Vector2d& uv) const;
  /// The inverse.
  Eigen::Vector2d distort(const Eigen::Vector2d& straight) const;
};

/// The lambda for which the located corners of each of the grid's lines (tag edges along rows and
/// columns) lie in line best: least sum of squared distances to the fitted lines, over the sum of
/// squared lengths so that shrinking the image gains nothing. 0 with fewer than `min_tags` tags,
/// and where no line has four corners.
DivisionDistortion estimateDistortion(const AprilGrid& grid, const std::vector<TagImage>& tags,
                                      const Resolution& resolution, std::size_t min_tags = 5);

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
