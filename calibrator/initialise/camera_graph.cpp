// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/initialise/camera_graph.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "calibrator/base/statistics/statistics.h"

namespace plumbline {
namespace {

/// T_AB of two cameras from every frame in which both have a pose.
std::vector<Transform> relativePoses(const CameraPoses& a, const CameraPoses& b) {
  std::vector<Transform> all;
  for (std::size_t f = 0; f < a.size(); ++f) {
    if (a[f] && b[f]) all.push_back(*a[f] * b[f]->inverse());
  }
  return all;
}

struct Edge {
  std::size_t from = 0, to = 0, shared = 0;
};

/// The edge with most shared frames from a camera that is reached to one that is not (a step of
/// Prim's algorithm). Empty (shared == 0) where no frame joins the two sides.
Edge widestEdge(const std::vector<CameraPoses>& poses, const std::vector<bool>& reached) {
  Edge best;
  for (std::size_t from = 0; from < poses.size(); ++from) {
    for (std::size_t to = 0; to < poses.size(); ++to) {
      if (!reached[from] || reached[to]) continue;
      const std::size_t shared = relativePoses(poses[from], poses[to]).size();
      if (shared > best.shared) best = {from, to, shared};
    }
  }
  return best;
}

Failure noOverlap(const std::vector<std::string>& names, const std::vector<bool>& reached) {
  std::vector<std::string> together;
  std::vector<std::string> apart;
  for (std::size_t c = 0; c < names.size(); ++c) {
    (reached[c] ? together : apart).push_back(names[c]);
  }
  return {FailureCode::kCamerasShareNoFrame, {{"apart", apart}, {"together", together}}};
}

/// Of some of them, the one with the least sum of distances to all.
Transform mostCentral(const std::vector<Transform>& transforms) {
  constexpr std::size_t kTried = 16;
  const std::size_t n = transforms.size();
  Transform best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < std::min(kTried, n); ++i) {
    // Steps of the golden ratio, so that gross errors at regular distances are not all that is
    // tried; one and the same may be tried twice.
    const double share = std::fmod(std::numbers::phi * static_cast<double>(i), 1.0);
    const Transform& candidate =
        transforms[static_cast<std::size_t>(share * static_cast<double>(n))];
    double sum = 0;
    for (const Transform& T : transforms) sum += boxminus(T, candidate).norm();
    if (!(sum < least)) continue;
    least = sum;
    best = candidate;
  }
  return best;
}

}  // namespace

Transform medianTransform(const std::vector<Transform>& transforms) {
  assert(!transforms.empty());
  // The first will do, unless it is a gross error: half a turn away the others' rotation vectors
  // point either way.
  constexpr double kGross_rad = 1;
  Transform middle = transforms.front();
  const Transform central = mostCentral(transforms);
  if (rotationAngle(middle.R.transpose() * central.R) > kGross_rad) middle = central;
  // Rotation vectors add like vectors only about a common reference that is close: the median
  // itself, found anew from its own tangent.
  for (int round = 0; round < 3; ++round) {
    std::vector<double> d[6];
    for (const Transform& T : transforms) {
      const Vector6d x = boxminus(T, middle);
      for (int k = 0; k < 6; ++k) d[k].push_back(x[k]);
    }
    Vector6d step;
    for (int k = 0; k < 6; ++k) step[k] = middleOf(d[k]);
    middle = boxplus(middle, step);
  }
  return middle;
}

Result<std::vector<Transform>> extrinsicsFromPoses(const std::vector<CameraPoses>& poses,
                                                   const std::vector<std::string>& names) {
  std::vector<Transform> T_C0Ci(poses.size());
  std::vector<bool> reached(poses.size(), false);
  reached[0] = true;
  for (std::size_t left = poses.size() - 1; left > 0; --left) {
    const Edge edge = widestEdge(poses, reached);
    if (edge.shared == 0) return noOverlap(names, reached);
    const Transform T = medianTransform(relativePoses(poses[edge.from], poses[edge.to]));
    T_C0Ci[edge.to] = T_C0Ci[edge.from] * T;
    reached[edge.to] = true;
  }
  return T_C0Ci;
}

}  // namespace plumbline
