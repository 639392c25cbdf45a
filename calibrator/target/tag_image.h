// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <vector>

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

/// The AprilTag library, set up for a grid's tags of tag36h11, whose small squares touch the tags.
/// Not for two threads at once: it keeps the library's state and a buffer.
class QuadFinder {
 public:
  QuadFinder(const AprilGrid& grid, const DetectorOptions& options);
  ~QuadFinder();
  QuadFinder(const QuadFinder&) = delete;
  QuadFinder& operator=(const QuadFinder&) = delete;

  /// Decoded squares, corners to about a pixel; an id may occur more than once. `dilation` is 2, or
  /// 3 for images whose blur bridges the gap that 2 opens (but it costs small tags).
  std::vector<TagImage> find(const GrayImageView& image, int dilation);

 private:
  struct Library;
  std::unique_ptr<Library> library_;
  GrayImage dilated_;
};

/// Each pixel becomes the brightest of the size x size pixels (2 or 3) around it, those to the
/// right and below if size is 2: dark shapes lose size - 1 pixels of width and height, so that
/// touching corners come apart. `out` is resized as needed.
void dilate(const GrayImageView& image, int size, GrayImage& out);

/// The surroundings of a corner, as far as they belong to it: an ellipse, image of a disc of the
/// target's plane.
struct CornerWindow {
  Eigen::Vector2d start = Eigen::Vector2d::Zero();  ///< guess [px]
  /// Columns: from the corner along the two edges of the tag, away from the tag's inside, to where
  /// the corner's surroundings end (the smaller of border width and small square) [px].
  Eigen::Matrix2d axes = Eigen::Matrix2d::Identity();
  double max_shift_px = 2;  ///< the corner must lie this close to the guess
};

/// Finds the point p that the gradients g around it point across best,
///   min_p sum_x w(x - p) (g(x) . (x - p))^2,
/// iterated with the weights moving along (W. Foerstner and E. Guelch, 1987), w falling smoothly to
/// zero at the edge of the window. It is unbiased for blur and noise that are alike on all sides.
/// Keeps a buffer: not for two threads at once.
class CornerRefiner {
 public:
  /// The corner [px], or nothing if the gradients do not single out a point, the point leaves
  /// max_shift_px, still moves after 15 steps (3 of 6674 in EuRoC's photographs, none of 16030 in
  /// rendered images), or the four sectors around it are not dark, light, dark, light.
  std::optional<Eigen::Vector2d> refine(const GrayImageView& image, const CornerWindow& window);

 private:
  struct Patch {
    int x0 = 0, y0 = 0, width = 0, height = 0;
    bool empty() const { return width < 3 || height < 3; }
  };
  /// Ellipse of the weights: they are zero where x' inverse_shape x >= 1.
  struct Window {
    Eigen::Matrix2d inverse_shape;
    Eigen::Vector2d reach;  ///< half of its extent in x and y [px]
  };
  /// The pixels of the patch that lie within reach of a point; may be empty.
  static Patch within(const Patch& patch, const Eigen::Vector2d& centre,
                      const Eigen::Vector2d& reach);
  void fillGradients(const GrayImageView& image, const Patch& patch);
  std::optional<Eigen::Vector2d> step(const Patch& patch, const Window& window,
                                      const Eigen::Vector2d& p) const;

  std::vector<float> gx_, gy_, smooth_, slope_;
};

}  // namespace plumbline
