// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

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

/// Which ends subTrajectories() accepts.
struct SubTrajectoryRule {
  double length = 1;      ///< [unit of the path]
  double tolerance = 0;   ///< largest difference from `length`
  bool inclusive = true;  ///< a difference of exactly `tolerance` is accepted
  bool may_stay = false;  ///< a pose may be its own end (j >= i instead of j > i)
};

/// From every pose i to the pose j whose distance along the path, path[j] - path[i], is nearest to
/// the rule's length, where it is within the rule's tolerance. rpg and ov_eval exclude the
/// tolerance, let a pose stay and go along the truth; evo's all pairs are the defaults, along the
/// estimate. `path` does not descend. O(n log n).
std::vector<IndexPair> subTrajectories(const std::vector<double>& path,
                                       const SubTrajectoryRule& rule);

/// evo's consecutive pairs by path: marks the poses at which at least `length` was travelled since
/// the last mark, and pairs neighbouring marks. The start is no mark, so the first stretch is lost.
std::vector<IndexPair> consecutiveStretches(const std::vector<Transform>& poses, double length);

}  // namespace plumbline
