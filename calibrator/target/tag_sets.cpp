// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/target/tag_sets.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
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

}  // namespace plumbline
