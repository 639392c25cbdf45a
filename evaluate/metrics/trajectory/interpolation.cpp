// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/trajectory/interpolation.h"

#include <algorithm>

namespace plumbline {

Interpolated poseAt(const std::vector<StampedPose>& poses, TimeNs t, TimeNs max_gap) {
  const auto after =
      std::lower_bound(poses.begin(), poses.end(), t,
                       [](const StampedPose& pose, TimeNs at) { return pose.t < at; });
  if (after == poses.end()) return {};
  if (after->t == t) return {*after, false};
  if (after == poses.begin()) return {};
  const StampedPose& a = *(after - 1);
  const StampedPose& b = *after;
  if (b.t - a.t > max_gap) return {std::nullopt, true};
  const double u = static_cast<double>(t - a.t) / static_cast<double>(b.t - a.t);
  const Eigen::Vector3d p = (1 - u) * a.p + u * b.p;
  return {StampedPose{t, p, a.q.normalized().slerp(u, b.q.normalized())}, false};
}

}  // namespace plumbline
