// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "calibrator/base/image.h"
#include "calibrator/target/tag_image.h"

namespace plumbline {

/// The AprilTag library, set up for tags 0 ... tag_count - 1 of tag36h11 with a border of
/// `border_bits` cells and for grids whose small squares touch the tags. Not for two threads at
/// once: it keeps the library's state and a buffer.
class QuadFinder {
 public:
  struct Options {
    int tag_count = 36;
    int border_bits = 2;
    int max_hamming = 2;
    double decimation = 2.0;
  };
  explicit QuadFinder(const Options& options);
  ~QuadFinder();
  QuadFinder(const QuadFinder&) = delete;
  QuadFinder& operator=(const QuadFinder&) = delete;

  /// Decoded squares, corners to about a pixel; an id may occur more than once.
  std::vector<TagImage> find(const GrayImageView& image);

 private:
  struct Library;
  std::unique_ptr<Library> library_;
  GrayImage dilated_;
};

/// Each pixel becomes the brightest of itself, its right, lower and lower right neighbour: dark
/// shapes lose one pixel of width and height, so that touching corners come apart.
void dilate2x2(const GrayImageView& image, GrayImage& out);

}  // namespace plumbline
