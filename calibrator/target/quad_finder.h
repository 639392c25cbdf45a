// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/target/detector.h"
#include "calibrator/target/tag_image.h"

namespace plumbline {

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

}  // namespace plumbline
