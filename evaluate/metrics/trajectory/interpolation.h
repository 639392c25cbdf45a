// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "calibrator/base/trajectory.h"

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

}  // namespace plumbline
