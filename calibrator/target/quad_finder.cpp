// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/target/quad_finder.h"

#include <algorithm>
#include <cassert>

#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>

namespace plumbline {

/// Owns the library's objects. The family is cut down to the grid's ids, which keeps its decoding
/// table small; the full length is put back for its destructor.
struct QuadFinder::Library {
  apriltag_family_t* family = tag36h11_create();
  apriltag_detector_t* detector = apriltag_detector_create();

  explicit Library(const Options& options) {
    const int wider = options.border_bits - 1;
    family->ncodes = static_cast<std::uint32_t>(options.tag_count);
    family->width_at_border += 2 * wider;
    family->total_width += 2 * wider;
    for (std::uint32_t i = 0; i < family->nbits; ++i) {
      family->bit_x[i] += static_cast<std::uint32_t>(wider);
      family->bit_y[i] += static_cast<std::uint32_t>(wider);
    }
    detector->nthreads = 1;
    detector->quad_decimate = static_cast<float>(options.decimation);
    apriltag_detector_add_family_bits(detector, family, options.max_hamming);
  }
  ~Library() {
    apriltag_detector_destroy(detector);
    tag36h11_destroy(family);
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
};

QuadFinder::QuadFinder(const Options& options) : library_(std::make_unique<Library>(options)) {}
QuadFinder::~QuadFinder() = default;

void dilate2x2(const GrayImageView& image, GrayImage& out) {
  if (out.width() != image.width || out.height() != image.height) {
    out = GrayImage(image.width, image.height);
  }
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* upper = image.row(y);
    const std::uint8_t* lower = image.row(std::min(y + 1, image.height - 1));
    std::uint8_t* to = out.row(y);
    const int last = image.width - 1;
    for (int x = 0; x < last; ++x) {
      to[x] = std::max(std::max(upper[x], upper[x + 1]), std::max(lower[x], lower[x + 1]));
    }
    to[last] = std::max(upper[last], lower[last]);
  }
}

std::vector<TagImage> QuadFinder::find(const GrayImageView& image) {
  dilate2x2(image, dilated_);
  image_u8_t wrapped{dilated_.width(), dilated_.height(), dilated_.width(), dilated_.data()};
  zarray_t* found = apriltag_detector_detect(library_->detector, &wrapped);
  std::vector<TagImage> tags;
  for (int i = 0; i < zarray_size(found); ++i) {
    apriltag_detection_t* each = nullptr;
    zarray_get(found, i, &each);
    TagImage tag{.id = each->id, .source = TagSource::kLibrary, .hamming = each->hamming};
    // The library counts from the outer edge of the first pixel (-0.5 in our pixels), and the
    // dilation shortens dark squares on two sides (+0.5 on average): the two cancel.
    for (std::size_t k = 0; k < 4; ++k) tag.uv[k] = {each->p[k][0], each->p[k][1]};
    tags.push_back(tag);
  }
  apriltag_detections_destroy(found);
  return tags;
}

}  // namespace plumbline
