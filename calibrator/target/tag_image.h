// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <optional>

#include "calibrator/base/image.h"
#include "calibrator/target/detector.h"

namespace plumbline {

/// Corners of a tag in an image in Kalibr's order (bottom-left, bottom-right, top-right, top-left
/// of the upright tag) [px].
using TagCorners = std::array<Eigen::Vector2d, 4>;

/// A tag in an image while it is being worked on.
struct TagImage {
  int id = 0;
  TagSource source = TagSource::kLibrary;
  int hamming = 0;
  TagCorners uv = {};
  std::array<bool, 4> located = {};  ///< refined and not refused since

  bool hasCorners() const {
    return std::any_of(located.begin(), located.end(), [](bool b) { return b; });
  }
};

/// Length of the shortest edge [px].
inline double shortestEdge(const TagCorners& uv) {
  double least = (uv[0] - uv[3]).norm();
  for (std::size_t k = 0; k < 3; ++k) least = std::min(least, (uv[k + 1] - uv[k]).norm());
  return least;
}

/// Twice the area, positive if the corners run counter-clockwise as a viewer in front of the target
/// sees them (v runs down) [px^2].
inline double signedDoubleArea(const TagCorners& uv) {
  const Eigen::Vector2d a = uv[2] - uv[0];
  const Eigen::Vector2d b = uv[3] - uv[1];
  return a.y() * b.x() - a.x() * b.y();
}

/// Whether a place lies `border` and more within the centres of the outermost pixels.
inline bool isInside(const Eigen::Vector2d& uv, const Resolution& size, double border = 0) {
  return uv.x() >= border && uv.y() >= border && uv.x() <= size.width - 1 - border &&
         uv.y() <= size.height - 1 - border;
}

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
