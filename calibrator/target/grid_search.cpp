// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/target/grid_search.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <numeric>

#include "calibrator/base/statistics/statistics.h"

namespace plumbline {
namespace {

/// Largest distance between two tags that judge each other [tags].
constexpr int kReachTags = 2;
/// Error of a corner predicted by a tag `distance` tags away, as a share of the edge there.
constexpr double kTolerancePerTag = 0.25;

/// Largest error of `other`'s corners as predicted from `tag` alone, over its shortest edge.
double predictionError(const AprilGrid& grid, const TagImage& tag, const TagImage& other) {
  const Eigen::Matrix3d H = squareToQuad(tag.uv);
  const Eigen::Vector2d origin = grid.corner(4 * tag.id);
  double worst = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector2d at =
        (grid.corner(4 * other.id + static_cast<int>(k)) - origin) / grid.tag_size;
    const Eigen::Vector3d p = H * Eigen::Vector3d(at.x(), at.y(), 1);
    if (!(p.z() > 0)) return HUGE_VAL;
    worst = std::max(worst, (p.head<2>() / p.z() - other.uv[k]).norm());
  }
  return worst / shortestEdge(other.uv);
}

/// Both ways: a small square extrapolates badly, and either may be the wrong one. The tolerance
/// grows with the distance, as extrapolation does.
bool agree(const AprilGrid& grid, const TagImage& a, const TagImage& b) {
  const int distance = std::max(std::abs(a.id % grid.cols - b.id % grid.cols),
                                std::abs(a.id / grid.cols - b.id / grid.cols));
  if (distance == 0 || distance > kReachTags) return false;
  const double tolerance = kTolerancePerTag * distance;
  return predictionError(grid, a, b) < tolerance && predictionError(grid, b, a) < tolerance;
}

/// Label of the connected component of each tag under `agree`.
std::vector<std::size_t> components(const AprilGrid& grid, const std::vector<TagImage>& tags) {
  std::vector<std::size_t> label(tags.size());
  std::iota(label.begin(), label.end(), std::size_t{0});
  for (std::size_t i = 0; i < tags.size(); ++i) {
    for (std::size_t j = i + 1; j < tags.size(); ++j) {
      if (label[i] == label[j] || !agree(grid, tags[i], tags[j])) continue;
      const std::size_t from = label[j];
      std::replace(label.begin(), label.end(), from, label[i]);
    }
  }
  return label;
}

/// Gap over tag size from four points in line with edges at 0, 1, 1 + s and 2 + s of the target:
/// the cross ratio (p2 - p0)(p3 - p1) / ((p2 - p1)(p3 - p0)) = (1 + s)^2 / (s (2 + s)).
double gapFromCrossRatio(const Eigen::Vector2d& p0, const Eigen::Vector2d& p1,
                         const Eigen::Vector2d& p2, const Eigen::Vector2d& p3) {
  const double ratio = (p2 - p0).norm() * (p3 - p1).norm() / ((p2 - p1).norm() * (p3 - p0).norm());
  // (1 + s)^2 = c / (c - 1) with c the ratio, since s (2 + s) = (1 + s)^2 - 1.
  return ratio > 1 ? std::sqrt(ratio / (ratio - 1)) - 1 : HUGE_VAL;
}

void addGaps(const TagImage& low, const TagImage& high, std::array<std::size_t, 4> corners,
             std::vector<double>& gaps) {
  const auto [a, b, c, d] = corners;
  if (!low.located[a] || !low.located[b] || !high.located[c] || !high.located[d]) return;
  gaps.push_back(gapFromCrossRatio(low.uv[a], low.uv[b], high.uv[c], high.uv[d]));
}

}  // namespace

std::vector<std::vector<TagImage>> consistentSets(const AprilGrid& grid,
                                                  const std::vector<TagImage>& tags) {
  std::vector<TagImage> upright;
  std::copy_if(tags.begin(), tags.end(), std::back_inserter(upright), [&](const TagImage& tag) {
    return tag.id < grid.tagCount() && signedDoubleArea(tag.uv) > 0;
  });
  std::stable_sort(upright.begin(), upright.end(), [](const TagImage& a, const TagImage& b) {
    return a.id != b.id ? a.id < b.id : a.hamming < b.hamming;
  });
  const std::vector<std::size_t> label = components(grid, upright);
  std::vector<std::vector<TagImage>> sets;
  for (std::size_t group = 0; group < upright.size(); ++group) {
    std::vector<TagImage> members;
    for (std::size_t i = 0; i < upright.size(); ++i) {
      if (label[i] != group) continue;
      // Of one id, the reading with the fewest wrong cells stands first.
      if (members.empty() || members.back().id != upright[i].id) members.push_back(upright[i]);
    }
    if (!members.empty()) sets.push_back(std::move(members));
  }
  std::stable_sort(sets.begin(), sets.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return sets;
}

std::optional<double> apparentSpacing(const AprilGrid& grid, const std::vector<TagImage>& tags) {
  std::vector<double> gaps;
  for (const TagImage& low : tags) {
    for (const TagImage& high : tags) {
      if (high.id == low.id + 1 && high.id % grid.cols != 0) {
        addGaps(low, high, {0, 1, 0, 1}, gaps);
        addGaps(low, high, {3, 2, 3, 2}, gaps);
      } else if (high.id == low.id + grid.cols) {
        addGaps(low, high, {0, 3, 0, 3}, gaps);
        addGaps(low, high, {1, 2, 1, 2}, gaps);
      }
    }
  }
  if (gaps.empty()) return std::nullopt;
  return middleOf(std::move(gaps));
}

namespace {

/// A corner's own surroundings end with the black border inside and the small square outside; this
/// share of them is used, since blur carries in what lies beyond.
constexpr double kUsedShare = 0.9;

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

void GridSearch::refineCorners(TagImage& tag) const {
  const Eigen::Matrix3d H = squareToQuad(tag.uv);
  const double cells = tagCells(options_.border_bits);
  // Over the tag's edge: the border inside is border_bits cells wide, the small square outside as
  // the gap.
  const double reach = kUsedShare * std::min(options_.border_bits / cells, grid_.spacing);
  const double max_shift = std::clamp(0.12 * shortestEdge(tag.uv), 2.0, 8.0);
  for (std::size_t k = 0; k < 4; ++k) {
    if (tag.located[k]) continue;
    const CornerWindow window{tag.uv[k], outwardAxes(H, k, reach), max_shift};
    const std::optional<Eigen::Vector2d> corner = refiner_.refine(image_, window);
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
