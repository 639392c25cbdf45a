// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/time.h"
#include "evaluate/metrics/trajectory/aligned_poses.h"
#include "evaluate/metrics/trajectory/pose_pairs.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

/// What is measured of the error of a relative motion, E = (Q_i^-1 Q_j)^-1 (P_i^-1 P_j) with the
/// truth's poses Q and the estimate's P.
enum class RelativeMeasure {
  kTranslation,  ///< |t_E| [m]
  kRotationDeg,  ///< angle of R_E [deg]
  kHeadingDeg,   ///< |yaw| of R_E turned into the frame of the world, R_Pj R_E R_Pj^T (rpg)
  kGravityDeg,   ///< sqrt(pitch^2 + roll^2) of the same [deg]
};

/// One value for each of `pairs`, in their order. Invariant under rigid motions of the truth and,
/// but for kHeadingDeg and kGravityDeg, of the estimate; not under a change of scale.
std::vector<double> relativeErrors(const AlignedPoses& poses, const std::vector<IndexPair>& pairs,
                                   RelativeMeasure measure);

/// Between which poses relative motion is judged; docs/trajectory_conventions.md compares them.
enum class RelativePairs {
  kPlumbline,  ///< from every pose, along the truth, within 10 % of the distance
  kEvo,        ///< one after the other, along the estimate: the tool's default
  kEvoAll,     ///< its all_pairs: from every pose, along the estimate, within 10 %
  kRpg,        ///< from every pose, along the truth, within 20 %; a pose may be its own end
  kOvEval,     ///< likewise within 0.5 m
};

/// "plumbline", "evo", "evo-all", "rpg", "ov_eval".
const char* nameOf(RelativePairs pairs);

/// A distance over which relative motion is judged.
struct RelativeDelta {
  double delta = 1;
  enum class Unit { kFrames, kMetres, kSeconds } unit = Unit::kMetres;
  RelativePairs pairs = RelativePairs::kPlumbline;
};

/// Whether the tool has such pairs: evo over frames and metres, rpg and ov_eval over metres.
bool hasPairsOver(RelativePairs pairs, RelativeDelta::Unit unit);

/// "frames", "m", "s".
const char* nameOf(RelativeDelta::Unit unit);

/// By delta.pairs, which hasPairsOver() delta.unit. This program's pairs are overlapping, from
/// every matched pose. Frames: i to i + delta. Metres and seconds: to the pose whose path along the
/// truth, or whose time, is nearest to delta, and within 10 % of it. `t`: stamps of the pairs.
std::vector<IndexPair> pairsOver(const RelativeDelta& delta, const AlignedPoses& poses,
                                 const std::vector<TimeNs>& t);

/// Statistics of both parts over pairsOver(); n = 0 where the trajectory is shorter than delta.
RelativeErrorRecord relativeErrorOver(const RelativeDelta& delta, const AlignedPoses& poses,
                                      const std::vector<TimeNs>& t);

}  // namespace plumbline
