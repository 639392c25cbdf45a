// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "calibrator/base/enum_words.h"
#include "calibrator/base/transform.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

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
