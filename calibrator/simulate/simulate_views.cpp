// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "calibrator/camera/camera.h"
#include "calibrator/simulate/random_stream.h"
#include "calibrator/simulate/simulate_session.h"
#include "calibrator/target/tag_image.h"

namespace plumbline {
namespace {

/// The four corners of a tag in the image; empty where a detector would not see the tag.
template <class Projection>
std::optional<TagCorners> projectTag(const Resolution& resolution, const Projection& project,
                                     int tag, const SimulationOptions& o) {
  TagCorners corners;
  for (int k = 0; k < 4; ++k) {
    const auto uv = project(4 * tag + k);
    if (!uv || !isInside(*uv, resolution, o.border_px)) return std::nullopt;
    corners[k] = *uv;
  }
  for (std::size_t k = 0; k < 4; ++k) {
    if ((corners[(k + 1) % 4] - corners[k]).norm() < o.min_tag_px) return std::nullopt;
  }
  return corners;
}

/// tagEdgeScale() of the tag whose corners begin with id `first`, by its edges as the detector has
/// them, wider by `relative` where they span kTagEdgePx; 1 where it is not seen whole.
template <class Projection>
double edgeScaleOf(const Projection& project, int first, double relative) {
  double sum = 0;
  for (int k = 0; k < 4; ++k) {
    const auto a = project(first + k);
    const auto b = project(first + (k + 1) % 4);
    if (!a || !b) return 1;
    sum += (*a - *b).norm();
  }
  // The larger root, which is the edge itself for relative = 0:
  // L = edge (1 + relative kTagEdgePx / L)
  const double edge = sum / 4;
  const double square = edge * (edge + 4 * relative * kTagEdgePx);
  return tagEdgeScale(0.5 * (edge + std::sqrt(std::max(0.0, square))));
}

}  // namespace

std::vector<Corner> visibleCorners(const Resolution& resolution, const CornerProjection& project,
                                   const SimulationOptions& o) {
  AprilGrid board = o.target;
  const double tag_edge = std::exchange(board.shape.terms[kTargetTerms - 1], 0);
  const std::vector<Eigen::Vector3d> points = cornerPoints(board);
  const auto exact = [&](int corner_id) { return project(corner_id, points[corner_id]); };
  const auto projection = [&](int corner_id) {
    if (tag_edge == 0) return exact(corner_id);
    const int k = corner_id % 4;
    // Half a unit outwards along x and y: an edge grows by what its two ends move.
    const Eigen::Vector3d outward(k == 1 || k == 2 ? 0.5 : -0.5, k == 2 || k == 3 ? 0.5 : -0.5, 0);
    const double wider = tag_edge * edgeScaleOf(exact, corner_id - k, tag_edge / board.tag_size);
    const Eigen::Vector3d& p = points[corner_id];
    return project(corner_id, p + wider * outward);
  };
  std::vector<Corner> corners;
  for (int tag = 0; tag < o.target.tagCount(); ++tag) {
    const auto seen = projectTag(resolution, projection, tag, o);
    if (!seen) continue;
    for (int k = 0; k < 4; ++k) {
      corners.push_back({4 * tag + k, (*seen)[k]});
    }
  }
  return corners;
}

std::vector<Corner> visibleCorners(const Intrinsics& camera, const Transform& T_FC,
                                   const SimulationOptions& o) {
  // Behind the board, whose back is not printed. A projection alone would see through it.
  if (T_FC.t.z() <= 0) return {};
  const Transform T_CF = T_FC.inverse();
  const auto projection = [&](int /*corner_id*/, const Eigen::Vector3d& p_F) {
    return project(camera, T_CF * p_F);
  };
  return visibleCorners(camera.resolution, projection, o);
}

std::vector<FrameStamp> simulateStamps(const std::vector<TimeNs>& nominal, int index,
                                       const SimulationOptions& o) {
  const auto camera = static_cast<std::uint64_t>(index);
  RandomStream jitter(o.seed, RandomPurpose::kStampJitter, {camera});
  RandomStream drop(o.seed, RandomPurpose::kDroppedFrames, {camera});
  std::vector<FrameStamp> stamps;
  stamps.reserve(nominal.size());
  for (std::size_t k = 0; k < nominal.size(); ++k) {
    // Drawn for dropped frames as well, so that dropping moves no other stamp.
    const double shift_s = o.stamp_jitter_s * jitter.uniform(-0.5, 0.5);
    if (drop.uniform() < o.dropped_fraction) continue;
    stamps.push_back({k, nominal[k] + toNanoseconds(shift_s)});
  }
  return stamps;
}

void disturbCorners(std::vector<Corner>& corners, const Resolution& resolution, int camera,
                    std::uint64_t frame, const SimulationOptions& o) {
  const auto index = static_cast<std::uint64_t>(camera);
  // One stream for each view, and numbers drawn for every corner of the target, seen or not: what
  // is visible elsewhere never changes a corner's noise.
  RandomStream noise(o.seed, RandomPurpose::kCornerNoise, {index, frame});
  RandomStream outlier(o.seed, RandomPurpose::kOutliers, {index, frame});
  auto corner = corners.begin();
  for (int id = 0; id < o.target.cornerCount() && corner != corners.end(); ++id) {
    const double n_u = o.corner_sigma_px > 0 ? noise.normal() : 0;
    const double n_v = o.corner_sigma_px > 0 ? noise.normal() : 0;
    // All three whether it is one or not, so that the share of outliers moves no other number.
    const bool is_outlier = outlier.uniform() < o.outlier_fraction;
    const double direction = outlier.uniform(0, 2 * std::numbers::pi);
    const double length = o.outlier_px * outlier.uniform(0.5, 1.5);
    if (corner->id != id) continue;
    corner->uv += o.corner_sigma_px * Eigen::Vector2d(n_u, n_v);
    if (is_outlier) {
      corner->uv += length * Eigen::Vector2d(std::cos(direction), std::sin(direction));
      corner->uv.x() = std::clamp(corner->uv.x(), 0.0, resolution.width - 1.0);
      corner->uv.y() = std::clamp(corner->uv.y(), 0.0, resolution.height - 1.0);
    }
    ++corner;
  }
  std::erase_if(corners, [&](const Corner& c) { return !isInside(c.uv, resolution, 0); });
}

}  // namespace plumbline
