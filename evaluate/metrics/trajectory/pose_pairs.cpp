// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/trajectory/pose_pairs.h"

#include <cassert>
#include <cmath>

#include "evaluate/metrics/trajectory/nearest.h"

namespace plumbline {

std::vector<double> pathLengths(const std::vector<Transform>& poses) {
  std::vector<double> path(poses.size(), 0.0);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    path[i] = path[i - 1] + (poses[i].t - poses[i - 1].t).norm();
  }
  return path;
}

std::vector<IndexPair> overlappingFrames(std::size_t poses, std::size_t step) {
  assert(step > 0);
  std::vector<IndexPair> pairs;
  for (std::size_t i = 0; i + step < poses; ++i) pairs.push_back({i, i + step});
  return pairs;
}

std::vector<IndexPair> consecutiveFrames(std::size_t poses, std::size_t step) {
  assert(step > 0);
  std::vector<IndexPair> pairs;
  for (std::size_t i = 0; i + step < poses; i += step) pairs.push_back({i, i + step});
  return pairs;
}

std::vector<IndexPair> subTrajectories(const std::vector<double>& path,
                                       const SubTrajectoryRule& rule) {
  std::vector<IndexPair> pairs;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const std::size_t from = rule.may_stay ? i : i + 1;
    if (from >= path.size()) break;
    const std::size_t to = firstNearest(path, path[i] + rule.length, from);
    const double miss = std::abs(path[to] - (path[i] + rule.length));
    if (miss < rule.tolerance || (rule.inclusive && miss <= rule.tolerance)) {
      pairs.push_back({i, to});
    }
  }
  return pairs;
}

std::vector<IndexPair> consecutiveStretches(const std::vector<Transform>& poses, double length) {
  std::vector<IndexPair> pairs;
  std::size_t mark = 0;
  bool marked = false;
  double travelled = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    travelled += (poses[i].t - poses[i - 1].t).norm();
    if (travelled < length) continue;
    if (marked) pairs.push_back({mark, i});
    mark = i;
    marked = true;
    travelled = 0;
  }
  return pairs;
}

}  // namespace plumbline
