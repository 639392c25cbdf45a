// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/target/grid_search.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "calibrator/target/corner_fit.h"

namespace plumbline {
namespace {

/// A corner's own surroundings end with the black border inside and the small square outside; this
/// share of them is used, since blur carries in what lies beyond.
constexpr double kUsedShare = 0.9;

/// What the fit moves further than this from where the refiner left it is no corner [px].
constexpr double kMostFitted_px = 1.0;

/// Corner positions in the unit square that squareToQuad maps.
constexpr std::array<std::array<int, 2>, 4> kUnitCorners = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};

/// Images of the two edge directions at corner k, away from the tag, each of length `reach` times
/// the tag's edge there: derivatives of the homography.
Eigen::Matrix2d outwardAxes(const Eigen::Matrix3d& H, std::size_t k, double reach) {
  const auto [x, y] = kUnitCorners[k];
  const Eigen::Vector3d p = H * Eigen::Vector3d(x, y, 1);
  const Eigen::Vector2d uv = p.head<2>() / p.z();
  Eigen::Matrix2d axes;
  for (int axis = 0; axis < 2; ++axis) {
    const double outward = (axis == 0 ? x : y) == 1 ? 1 : -1;
    axes.col(axis) = outward * reach * (H.col(axis).head<2>() - H(2, axis) * uv) / p.z();
  }
  return axes;
}

}  // namespace

GridSearch::GridSearch(const AprilGrid& grid, const DetectorOptions& options,
                       const GrayImageView& image, CornerRefiner& refiner)
    : grid_(grid), options_(options), image_(image), refiner_(refiner) {}

bool GridSearch::has(int tag_id) const {
  return std::any_of(tags_.begin(), tags_.end(),
                     [&](const TagImage& tag) { return tag.id == tag_id; });
}

/// Of the eight tags around, those that are known.
int GridSearch::neighboursOf(int tag_id) const {
  return static_cast<int>(std::count_if(tags_.begin(), tags_.end(), [&](const TagImage& tag) {
    return std::abs(tag.id % grid_.cols - tag_id % grid_.cols) <= 1 &&
           std::abs(tag.id / grid_.cols - tag_id / grid_.cols) <= 1;
  }));
}

std::array<CornerWindow, 4> GridSearch::windowsOf(const TagImage& tag, double max_shift_px) const {
  const Eigen::Matrix3d H = squareToQuad(tag.uv);
  const double cells = tagCells(options_.border_bits);
  // Over the tag's edge: the border inside is border_bits cells wide, the small square outside as
  // the gap.
  const double reach = kUsedShare * std::min(options_.border_bits / cells, grid_.spacing);
  std::array<CornerWindow, 4> windows;
  for (std::size_t k = 0; k < 4; ++k) {
    windows[k] = {tag.uv[k], outwardAxes(H, k, reach), max_shift_px};
  }
  return windows;
}

void GridSearch::refineCorners(TagImage& tag) const {
  const double max_shift = std::clamp(0.12 * shortestEdge(tag.uv), 2.0, 8.0);
  const std::array<CornerWindow, 4> windows = windowsOf(tag, max_shift);
  for (std::size_t k = 0; k < 4; ++k) {
    if (tag.located[k]) continue;
    const std::optional<Eigen::Vector2d> corner = refiner_.refine(image_, windows[k]);
    tag.located[k] = corner.has_value();
    if (corner) tag.uv[k] = *corner;
  }
}

std::optional<TagImage> GridSearch::lookFor(int tag_id, const LocalMap& map) const {
  TagImage tag{.id = tag_id, .source = TagSource::kGrid};
  for (int k = 0; k < 4; ++k) {
    const std::optional<Eigen::Vector2d> uv = map.predict(4 * tag_id + k, -1);
    if (!uv) return std::nullopt;
    tag.uv[k] = *uv;
  }
  if (shortestEdge(tag.uv) < options_.min_edge_px || signedDoubleArea(tag.uv) <= 0) {
    return std::nullopt;
  }
  refineCorners(tag);
  if (!tag.hasCorners()) return std::nullopt;
  // Last, for it needs the corners; it alone says that there is a tag and which.
  const std::optional<int> distance =
      payloadDistance(image_, tag, options_.border_bits, options_.min_contrast);
  if (!distance || *distance > options_.max_hamming) return std::nullopt;
  tag.hamming = *distance;
  return tag;
}

void GridSearch::grow() {
  std::vector<int> tried_with(static_cast<std::size_t>(grid_.tagCount()), 0);
  bool grown = true;
  while (grown) {
    grown = false;
    const LocalMap known = map();
    for (int id = 0; id < grid_.tagCount(); ++id) {
      if (has(id)) continue;
      const int neighbours = neighboursOf(id);
      // Again only once more neighbours are known: at most eight times, so that it ends.
      if (neighbours <= tried_with[id]) continue;
      tried_with[id] = neighbours;
      if (const std::optional<TagImage> tag = lookFor(id, known)) {
        const auto place = std::find_if(tags_.begin(), tags_.end(),
                                        [&](const TagImage& other) { return other.id > id; });
        tags_.insert(place, *tag);
        grown = true;
      }
    }
  }
}

void GridSearch::completeCorners() {
  const LocalMap known = map();
  for (TagImage& tag : tags_) {
    for (std::size_t k = 0; k < 4; ++k) {
      if (tag.located[k]) continue;
      const std::optional<Eigen::Vector2d> expected =
          known.predict(4 * tag.id + static_cast<int>(k), -1);
      if (expected) tag.uv[k] = *expected;
    }
    refineCorners(tag);
  }
}

void GridSearch::fitCorners() {
  // The refiner's corners, off by hundredths of a pixel, tell it.
  const DivisionDistortion distortion = refineDistortion(
      grid_, tags_, estimateDistortion(grid_, tags_, {image_.width, image_.height}));
  for (TagImage& tag : tags_) {
    const std::array<CornerWindow, 4> windows = windowsOf(tag, kMostFitted_px);
    for (std::size_t k = 0; k < 4; ++k) {
      if (!tag.located[k]) continue;
      const std::optional<Eigen::Vector2d> corner = fitCorner(image_, windows[k], distortion);
      tag.located[k] = corner.has_value();
      if (corner) tag.uv[k] = *corner;
    }
  }
  removeEmptyTags();
}

void GridSearch::checkAgainstNeighbours() {
  const LocalMap known = map();
  for (TagImage& tag : tags_) {
    const double limit = options_.max_grid_error_px + 0.03 * shortestEdge(tag.uv);
    for (std::size_t k = 0; k < 4; ++k) {
      if (!tag.located[k]) continue;
      const std::optional<Eigen::Vector2d> expected =
          // Without the tag's own corners: read wrongly, they would vouch for each other.
          known.predict(4 * tag.id + static_cast<int>(k), tag.id);
      // A corner for which no neighbour can vouch goes as well.
      if (expected && (*expected - tag.uv[k]).norm() <= limit) continue;
      tag.located[k] = false;
    }
  }
  removeEmptyTags();
}

void GridSearch::dropAtBorder() {
  const double d = options_.min_border_distance_px;
  for (TagImage& tag : tags_) {
    for (std::size_t k = 0; k < 4; ++k) {
      const bool inside = isInside(tag.uv[k], {image_.width, image_.height}, d);
      tag.located[k] = tag.located[k] && inside;
    }
  }
  removeEmptyTags();
}

void GridSearch::removeEmptyTags() {
  std::erase_if(tags_, [](const TagImage& tag) { return !tag.hasCorners(); });
}

}  // namespace plumbline
