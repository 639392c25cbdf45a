// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/target/tag_image.h"

namespace plumbline {

using Moments = Eigen::Matrix<double, 6, 1>;

/// 1, x, y, x x, x y, y y: summed over points, their number and first and second moments.
inline Moments moments(const Eigen::Vector2d& p) {
  Moments m;
  m << 1, p.x(), p.y(), p.x() * p.x(), p.x() * p.y(), p.y() * p.y();
  return m;
}

/// 1 + l1 s + l2 s^2 + l3 s^3 of s = |d|^2, one or many: what the division model divides by.
template <typename Terms, typename Squares>
Squares divisor(const Terms& terms, const Squares& s) {
  return 1 + s * (terms[0] + s * (terms[1] + s * terms[2]));
}

/// The division model of lens distortion (A. Fitzgibbon, CVPR 2001) about a known centre: with
/// d = (uv - centre) / radius,
///   straight = centre + radius * d / divisor(l1, l2, l3; |d|^2),
/// so that straight lines of the world are straight lines of `straight`. l1 < 0 is barrel
/// distortion. By l1 alone it is good to a few pixels for any lens, which is enough to tell where a
/// tag is; all three tell how much an edge bends within some pixels.
struct DivisionDistortion {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< [px]
  double radius = 1;                                 ///< [px], sets the scale of the terms
  Eigen::Vector3d terms = Eigen::Vector3d::Zero();   ///< l1, l2, l3

  /// Of a pixel whose divisor is positive.
  Eigen::Vector2d straighten(const Eigen::Vector2d& uv) const;
  /// d straighten / d uv, 2x2.
  Eigen::Matrix2d jacobian(const Eigen::Vector2d& uv) const;
  /// The inverse of straighten() where l2 = l3 = 0.
  Eigen::Vector2d distort(const Eigen::Vector2d& straight) const;
};

/// The l1 for which the located corners of each of the grid's lines (tag edges along rows and
/// columns) lie in line best: least sum of squared distances to the fitted lines, over the sum of
/// squared lengths so that shrinking the image gains nothing. 0 with fewer than `min_tags` tags,
/// and where no line has four corners.
DivisionDistortion estimateDistortion(const AprilGrid& grid, const std::vector<TagImage>& tags,
                                      const Resolution& resolution, std::size_t min_tags = 5);

/// The same over all three terms, by Newton's method from `start`; `start` where it has no term
/// (too few tags), and where the sum is not convex there or a step does not lower it.
DivisionDistortion refineDistortion(const AprilGrid& grid, const std::vector<TagImage>& tags,
                                    const DivisionDistortion& start);

}  // namespace plumbline
