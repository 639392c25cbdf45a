// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/target/detector.h"

#include <algorithm>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/base/option_check.h"
#include "calibrator/target/grid_search.h"
#include "calibrator/target/quad_finder.h"
#include "calibrator/target/tag_sets.h"

namespace plumbline {
namespace {

/// The library needs some room; no tag is that small.
constexpr int kMinSide_px = 16;
/// Sets of squares from which the grid is tried to grow.
constexpr std::size_t kSetsTried = 3;

/// Squares the library read as a tag that is not there in the grid found.
int countContradicting(const std::vector<TagImage>& squares, const std::vector<TagImage>& tags) {
  return static_cast<int>(
      std::count_if(squares.begin(), squares.end(), [&](const TagImage& square) {
        return std::none_of(tags.begin(), tags.end(), [&](const TagImage& tag) {
          return tag.id == square.id &&
                 (tag.uv[0] - square.uv[0]).norm() < 0.5 * shortestEdge(tag.uv);
        });
      }));
}

void append(Detection& detection, const TagImage& tag) {
  DetectedTag found{tag.id, tag.source, tag.hamming, 0};
  for (std::size_t k = 0; k < 4; ++k) {
    if (!tag.located[k]) continue;
    detection.corners.push_back({4 * tag.id + static_cast<int>(k), tag.uv[k]});
    ++found.corners;
  }
  detection.tags.push_back(found);
}

}  // namespace

void DetectorOptions::check() const {
  requireOption(border_bits == 1 || border_bits == 2, "detector.border_bits", border_bits,
                "1 or 2");
  requireOption(decimation >= 1 && decimation <= 8, "detector.decimation", decimation, "1 to 8");
  requireOption(max_hamming >= 0 && max_hamming <= 2, "detector.max_hamming", max_hamming,
                "0 to 2");
  requireOption(min_border_distance_px >= 0, "detector.min_border_distance_px",
                min_border_distance_px, "0 or more");
  requireOption(min_edge_px >= 4, "detector.min_edge_px", min_edge_px, "4 or more");
  requireOption(max_grid_error_px > 0, "detector.max_grid_error_px", max_grid_error_px,
                "more than 0");
  requireOption(min_contrast >= 1 && min_contrast <= 128, "detector.min_contrast", min_contrast,
                "1 to 128");
  requireOption(min_tags >= 2, "detector.min_tags", min_tags, "2 or more");
}

struct AprilGridDetector::Parts {
  AprilGrid grid;
  DetectorOptions options;
  QuadFinder finder;
  CornerRefiner refiner;

  /// Grows the grid from the largest consistent set of squares that leads anywhere.
  Detection searchFrom(std::vector<TagImage> squares, const GrayImageView& image);
};

Detection AprilGridDetector::Parts::searchFrom(std::vector<TagImage> squares,
                                               const GrayImageView& image) {
  std::erase_if(squares, [&](const TagImage& square) {
    return shortestEdge(square.uv) < options.min_edge_px;
  });
  GridSearch search(grid, options, image, refiner);
  // First, so that sets are judged by corners to a fraction of a pixel.
  for (TagImage& square : squares) search.refineCorners(square);
  std::vector<std::vector<TagImage>> sets = consistentSets(grid, squares);
  if (sets.size() > kSetsTried) sets.resize(kSetsTried);
  Detection detection;
  detection.rejected_tags = static_cast<int>(squares.size());  // where none agree with the grid
  // From the squares as they are: with a wrong spacing the grid's own checks drop most corners.
  if (!sets.empty()) detection.spacing = apparentSpacing(grid, sets.front());
  for (const std::vector<TagImage>& set : sets) {
    search.start(set);
    search.grow();
    search.completeCorners();
    search.fitCorners();
    // Before the corners at the border go: they vouch for their neighbours.
    search.checkAgainstNeighbours();
    // Before the corners at the border go, too: a tag that leaves with them contradicts nothing.
    const int contradicting = countContradicting(squares, search.tags());
    search.dropAtBorder();
    const auto found = static_cast<int>(search.tags().size());
    // More squares against the grid than tags in it: it was grown from misreadings.
    const bool accepted = found >= options.min_tags && found > contradicting;
    // Where no set is accepted, what contradicts the largest.
    if (accepted || &set == &sets.front()) detection.rejected_tags = contradicting;
    if (!accepted) continue;
    for (const TagImage& tag : search.tags()) append(detection, tag);
    return detection;
  }
  return detection;
}

AprilGridDetector::AprilGridDetector(const AprilGrid& grid, const DetectorOptions& options) {
  if (grid.rows < 1 || grid.cols < 1 || grid.tagCount() > kFamilySize || !(grid.tag_size > 0) ||
      !(grid.spacing > 0)) {
    throw InputError(
        fmt::format("AprilGrid of {} x {} tags, tag size {} m, spacing {}: expected 1 to {} tags "
                    "and positive sizes; correct the target description",
                    grid.rows, grid.cols, grid.tag_size, grid.spacing, kFamilySize));
  }
  options.check();
  parts_.reset(new Parts{grid, options, QuadFinder(grid, options), {}});
}
AprilGridDetector::~AprilGridDetector() = default;
AprilGridDetector::AprilGridDetector(AprilGridDetector&&) noexcept = default;
AprilGridDetector& AprilGridDetector::operator=(AprilGridDetector&&) noexcept = default;

Detection AprilGridDetector::detect(const GrayImageView& image) const {
  if (image.width < kMinSide_px || image.height < kMinSide_px) return {};
  std::vector<TagImage> squares = parts_->finder.find(image, 2);
  Detection detection = parts_->searchFrom(squares, image);
  if (!detection.tags.empty() || squares.empty()) return detection;
  // Only where 2 gave nothing, since it costs as much again; squares of both count.
  for (const TagImage& square : parts_->finder.find(image, 3)) squares.push_back(square);
  return parts_->searchFrom(squares, image);
}

}  // namespace plumbline
