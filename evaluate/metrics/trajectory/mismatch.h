// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "evaluate/metrics/trajectory/alignment.h"
#include "evaluate/metrics/trajectory/association.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

/// The scale by which the positions of `pairs` agree, where by lengths as they are they do not: s
/// of sim3 is outside of 0.8 to 1.25, the ATE after it at most half of that after se3, and a tenth
/// of the RMS distance of the truth from its mean. So an estimate that diverged, of which a small
/// scale makes a point, has none. Of all pairs, whatever the alignment of the figures. O(n).
std::optional<ScaleMismatch> scaleMismatch(const std::vector<PosePair>& pairs);

/// The offset d of the clocks, t_truth = t_estimate + d, by which the positions agree, where by the
/// stamps as they are they do not: the ATE with it is at most half of that without. `pairs` are
/// those that `options` make of the two trajectories, `kind` is se3 or sim3.
///
/// Gauss-Newton from 0 over the aligned errors e = p_truth - p_estimate, which an offset makes
/// e = v (dt - d), v the truth's velocity and dt the difference of a pair's stamps, truth -
/// estimate:
///   d = -sum (e - v dt)^T v / sum v^T v,
/// paired and aligned anew after each step. Errors of which the first step explains less than a
/// tenth (sum of squares) are not those of a clock: nothing more is computed, O(n). None beyond 2
/// s, where the steps do not settle, and where fewer than half of the pairs would be left.
std::optional<ClockMismatch> clockMismatch(const Trajectory& estimate, const Trajectory& truth,
                                           const std::vector<PosePair>& pairs,
                                           const AssociationOptions& options, AlignmentKind kind);

}  // namespace plumbline
