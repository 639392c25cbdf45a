// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/initialise/camera_graph.h"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

#include "calibrator/base/lie.h"
#include "calibrator/base/statistics.h"

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

std::size_t sharedFrames(const CameraPoses& a, const CameraPoses& b) {
  std::size_t shared = 0;
  for (std::size_t f = 0; f < a.size(); ++f) shared += a[f] && b[f] ? 1 : 0;
  return shared;
}

struct Edge {
  std::size_t from = 0, to = 0, shared = 0;
};

/// The edge with most shared frames from a camera that is reached to one that is not.
Edge widestEdge(const std::vector<CameraPoses>& poses, const std::vector<bool>& reached) {
  Edge best;
  for (std::size_t from = 0; from < poses.size(); ++from) {
    for (std::size_t to = 0; to < poses.size(); ++to) {
      if (!reached[from] || reached[to]) continue;
      const std::size_t shared = sharedFrames(poses[from], poses[to]);
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

}  // namespace

Transform medianTransform(const std::vector<Transform>& transforms) {
  assert(!transforms.empty());
  Transform middle = transforms.front();
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
