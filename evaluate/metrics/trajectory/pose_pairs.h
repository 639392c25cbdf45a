// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "calibrator/base/time.h"
#include "calibrator/base/transform.h"

namespace plumbline {

/// From one pose of a trajectory to a later one, by index.
struct IndexPair {
  std::size_t from = 0;
  std::size_t to = 0;
  bool operator==(const IndexPair&) const = default;
};

/// Length of the polygon through the poses' origins from the first to each [m]; the first is 0.
std::vector<double> pathLengths(const std::vector<Transform>& poses);

/// (i, i + step) for every i: all pairs, which overlap.
std::vector<IndexPair> overlappingFrames(std::size_t poses, std::size_t step);

/// (0, step), (step, 2 step), ...: evo's default, which leaves out all but every step-th pose.
std::vector<IndexPair> consecutiveFrames(std::size_t poses, std::size_t step);

/// From every pose i to the pose j whose distance along the path, path[j] - path[i], is nearest to
/// `length`, j > i or j >= i by `may_stay`, and within `tolerance` of it (or equal to it where
/// `inclusive`). O(n log n).
struct SubTrajectoryRule {
  double length = 1;     ///< [unit of path]
  double tolerance = 0;  ///< largest difference from `length`
  bool inclusive = true;
  bool may_stay = false;
};

/// rpg and ov_eval: strictly within the tolerance, j >= i, along the truth. evo's all pairs:
/// inclusive, j > i, along the estimate. `path` does not descend.
std::vector<IndexPair> subTrajectories(const std::vector<double>& path,
                                       const SubTrajectoryRule& rule);

/// evo's consecutive pairs by path: marks the poses at which at least `length` was travelled since
/// the last mark, and pairs neighbouring marks. The start is no mark, so the first stretch is lost.
std::vector<IndexPair> consecutiveStretches(const std::vector<Transform>& poses, double length);

}  // namespace plumbline
