// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
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

}  // namespace plumbline
