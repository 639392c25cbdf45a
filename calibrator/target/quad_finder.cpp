// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/target/quad_finder.h"

#include <algorithm>
#include <cassert>

#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>

namespace plumbline {

/// Owns the library's objects. The family is cut down to the grid's ids, which keeps its decoding
/// table small. Places of bits count from the border's corner, so that a wider border moves them.
struct QuadFinder::Library {
  apriltag_family_t* family = tag36h11_create();
  apriltag_detector_t* detector = apriltag_detector_create();

  Library(const AprilGrid& grid, const DetectorOptions& options) {
    const int wider = options.border_bits - 1;
    family->ncodes = static_cast<std::uint32_t>(grid.tagCount());
    family->width_at_border += 2 * wider;
    family->total_width += 2 * wider;
    for (std::uint32_t i = 0; i < family->nbits; ++i) {
      family->bit_x[i] += static_cast<std::uint32_t>(wider);
      family->bit_y[i] += static_cast<std::uint32_t>(wider);
    }
    // Images are detected side by side, each worker with a finder of its own: more threads within
    // one would only compete.
    detector->nthreads = 1;
    detector->quad_decimate = static_cast<float>(options.decimation);
    detector->qtp.min_white_black_diff = options.min_contrast;
    apriltag_detector_add_family_bits(detector, family, options.max_hamming);
  }
  ~Library() {
    apriltag_detector_destroy(detector);
    tag36h11_destroy(family);
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
};

QuadFinder::QuadFinder(const AprilGrid& grid, const DetectorOptions& options)
    : library_(std::make_unique<Library>(grid, options)) {}
QuadFinder::~QuadFinder() = default;

void dilate(const GrayImageView& image, int size, GrayImage& out) {
  assert(size == 2 || size == 3);
  if (out.width() != image.width || out.height() != image.height) {
    out = GrayImage(image.width, image.height);
  }
  // The largest of a square is that of the columns' largest: along v first, then along u.
  std::vector<std::uint8_t> column_max(static_cast<std::size_t>(image.width));
  const int before = (size - 1) / 2;
  const int last = image.width - 1;
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* above = image.row(std::max(y - before, 0));
    const std::uint8_t* here = image.row(y);
    const std::uint8_t* below = image.row(std::min(y + 1, image.height - 1));
    std::uint8_t* column = column_max.data();
    for (int x = 0; x <= last; ++x) column[x] = std::max(std::max(above[x], here[x]), below[x]);
    std::uint8_t* to = out.row(y);
    to[0] = std::max(column[0], column[std::min(1, last)]);
    for (int x = 1; x < last; ++x) {
      to[x] = std::max(std::max(column[x - before], column[x]), column[x + 1]);
    }
    to[last] = std::max(column[std::max(last - before, 0)], column[last]);
  }
}

std::vector<TagImage> QuadFinder::find(const GrayImageView& image, int dilation) {
  dilate(image, dilation, dilated_);
  image_u8_t wrapped{dilated_.width(), dilated_.height(), dilated_.width(), dilated_.data()};
  zarray_t* found = apriltag_detector_detect(library_->detector, &wrapped);
  // The library counts from the outer edge of the first pixel (-0.5 in our pixels); the dilation by
  // 2 shortens dark squares to the right and below (+0.5 on average), by 3 on all sides alike.
  const double shift = dilation == 2 ? 0 : -0.5;
  std::vector<TagImage> tags;
  for (int i = 0; i < zarray_size(found); ++i) {
    apriltag_detection_t* each = nullptr;
    zarray_get(found, i, &each);
    TagImage tag{.id = each->id, .source = TagSource::kLibrary, .hamming = each->hamming};
    for (std::size_t k = 0; k < 4; ++k) {
      tag.uv[k] = Eigen::Vector2d(each->p[k][0] + shift, each->p[k][1] + shift);
    }
    tags.push_back(tag);
  }
  apriltag_detections_destroy(found);
  return tags;
}

}  // namespace plumbline
