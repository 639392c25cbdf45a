// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "calibrator/base/image.h"
#include "calibrator/target/tag_image.h"

namespace plumbline {

/// The homography that maps the unit square, corners (0,0), (1,0), (1,1), (0,1), to four points
/// (P. Heckbert, Fundamentals of Texture Mapping, 1989, section 2.2.3). Four points of which no
/// three are in line.
Eigen::Matrix3d squareToQuad(const TagCorners& uv);

/// Image of a point (x, y) of the unit square.
inline Eigen::Vector2d mapPoint(const Eigen::Matrix3d& H, double x, double y) {
  const Eigen::Vector3d p = H * Eigen::Vector3d(x, y, 1);
  return p.head<2>() / p.z();
}

/// Grey value between pixels, bilinear; positions outside are moved to the nearest pixel.
double sampleBilinear(const GrayImageView& image, const Eigen::Vector2d& at);

/// Reads the payload of the tag whose corners are given and counts the cells that differ from the
/// code of tag.id. Black and white are told apart by the mean of the border's and of the
/// surrounding paper's grey, as planes over the tag (uneven light); cells of few pixels are
/// sharpened against their neighbours first. Empty where border and paper do not differ by
/// `min_contrast` grey levels, or where a payload cell lies outside the image.
std::optional<int> payloadDistance(const GrayImageView& image, const TagImage& tag, int border_bits,
                                   double min_contrast);

}  // namespace plumbline
