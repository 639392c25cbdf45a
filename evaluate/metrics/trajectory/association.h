// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "calibrator/base/enum_words.h"
#include "calibrator/base/transform.h"
#include "report/records/trajectory_record.h"

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

/// Median interval of stamps [s]; 0 for fewer than two.
double usualInterval(const std::vector<StampedPose>& poses);

struct Interpolated {
  std::optional<StampedPose> pose;  ///< none outside of the poses' span or within a wide gap
  bool in_gap = false;              ///< none because the neighbours are too far apart
};

/// The pose at `t` [ns] between its neighbours a and b in `poses` (by stamp, not descending):
///   p = (1 - u) p_a + u p_b,  q = slerp(q_a, q_b, u),  u = (t - t_a) / (t_b - t_a),
/// on the shorter arc, quaternions normalised first. A pose at exactly `t` is returned as it is
/// (the first of several). Neighbours more than `max_gap` apart give none. O(log n).
Interpolated poseAt(const std::vector<StampedPose>& poses, TimeNs t, TimeNs max_gap);

/// How stamps are paired; docs/trajectory_conventions.md compares them.
enum class AssociationRule {
  kOneToOne,     ///< closest pair first, no pose twice, on exact nanoseconds; |dt| <= max_dt_s
  kInterpolate,  ///< the truth at the estimate's stamps: linear and SLERP between its neighbours
  kEvo,          ///< nearest for each pose of the shorter one; a pose may be used twice
  kRpg,          ///< closest pair first, no pose twice; |dt| < max_dt_s
  kOvEval,       ///< one forward sweep, first local minimum of |dt| below max_dt_s
};

constexpr std::array<const char*, 5> enumWords(AssociationRule /*of*/) {
  return {"one-to-one", "interpolate", "evo", "rpg", "ov_eval"};
}

struct AssociationOptions {
  AssociationRule rule = AssociationRule::kOneToOne;
  double max_dt_s = 0.02;    ///< largest difference of paired stamps; unused by kInterpolate
  double max_gap_s = 0.1;    ///< kInterpolate: widest gap of the truth that is bridged
  double time_offset_s = 0;  ///< added to the estimate's stamps first
};

/// An estimated pose and the truth it is judged by. The estimate's stamp has the offset added; an
/// interpolated truth has the estimate's stamp.
struct PosePair {
  StampedPose estimate;
  StampedPose truth;
};

struct Association {
  std::vector<PosePair> pairs;  ///< in the order of the estimate
  AssociationRecord record;
  std::vector<std::size_t> estimate_index;  ///< of each pair: where its pose is in the estimate
};

/// Pairs the poses of `estimate` with those of `truth` and says what was odd: equal stamps, gaps,
/// the median difference (a clock offset), stamps at which a gap was too wide to interpolate. No
/// pairs is not an error here. The rules of the tools see stamps as the tools do, as doubles of
/// seconds, so that their ties break alike; the others see nanoseconds. O(n log n), linear memory.
Association associate(const Trajectory& estimate, const Trajectory& truth,
                      const AssociationOptions& options);

}  // namespace plumbline
