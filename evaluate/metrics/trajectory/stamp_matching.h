// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace plumbline {

/// The index i >= `from` that minimises |values[i] - target|, the first of those that tie, as a
/// search from the front finds it. `values` do not descend; from < values.size(). O(log n).
template <class T>
std::size_t firstNearest(const std::vector<T>& values, T target, std::size_t from) {
  assert(from < values.size());
  const auto begin = values.begin() + static_cast<std::ptrdiff_t>(from);
  auto nearest = std::lower_bound(begin, values.end(), target);
  if (nearest == values.end() ||
      (nearest != begin && target - *(nearest - 1) <= *nearest - target)) {
    nearest = std::lower_bound(begin, nearest, *(nearest - 1));
  }
  return static_cast<std::size_t>(nearest - values.begin());
}

/// Stamps on an integer grid, not descending.
using Ticks = std::vector<std::int64_t>;

/// One pose of the estimate and one of the truth, by their indices.
struct StampMatch {
  std::size_t estimate = 0;
  std::size_t truth = 0;
  bool operator==(const StampMatch&) const = default;
};

/// The rules by which stamps are paired. Each takes the largest difference in ticks (>= 0, may be
/// fractional) and returns the pairs in the order of the estimate. Memory is linear in the stamps.

/// Of all pairs with |dt| <= `max_dt` the closest first, ties by the index in the estimate, then in
/// the truth; no pose is used twice. O(n log n): the closest pair left is always one of neighbours
/// in the merged order, so a heap of neighbours suffices and far pairs are never enumerated.
std::vector<StampMatch> closestFirst(const Ticks& estimate, const Ticks& truth, double max_dt);

/// For each pose of the trajectory with fewer poses (the estimate if equal) the nearest of the
/// other, the earlier of two equally near, if |dt| <= `max_dt`. Not one-to-one: two poses may get
/// the same partner (evo, core/sync.py). O(n log n).
std::vector<StampMatch> nearestOfShorter(const Ticks& estimate, const Ticks& truth, double max_dt);

/// One sweep through the estimate with a cursor in the truth that never goes back: from the first
/// stamp of the truth within `max_dt` on, the first local minimum of |dt| below `max_dt`; the
/// cursor then stands behind it (ov_eval, AlignUtils::perform_association). One-to-one, but an
/// early pose may take the partner of a later, closer one. O(n).
std::vector<StampMatch> forwardSweep(const Ticks& estimate, const Ticks& truth, double max_dt);

}  // namespace plumbline
