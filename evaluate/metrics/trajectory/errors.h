// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "calibrator/base/enum_words.h"
#include "calibrator/base/time.h"
#include "calibrator/base/transform.h"
#include "evaluate/metrics/trajectory/alignment.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

/// From one pose of a trajectory to a later one, by index.
struct IndexPair {
  std::size_t from = 0;
  std::size_t to = 0;
  bool operator==(const IndexPair&) const = default;
};

/// Mean of points; zero for none.
Eigen::Vector3d meanOf(const std::vector<Eigen::Vector3d>& points);

/// RMS distance of points from their mean: the ATE of an estimate that never moves, after the best
/// alignment [their unit]; 0 for none.
double spreadOf(const std::vector<Eigen::Vector3d>& points);

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
/// the last mark, and pairs neighbouring marks. The start is no mark, so the first segment is lost.
std::vector<IndexPair> consecutiveSegments(const std::vector<Transform>& poses, double length);

/// What is measured of a pose's error, with E = R_estimate R_truth^T and d = p_estimate - p_truth,
/// both in the truth's frame.
enum class AbsoluteMeasure {
  kTranslation,         ///< |d| [m]
  kRotationDeg,         ///< angle of E [deg], 0 to 180
  kRotationPart,        ///< |E - I|_F = 2 sqrt(2) sin(angle / 2) (evo's rotation_part)
  kFullTransformation,  ///< sqrt(|E - I|_F^2 + |d|^2): metres and radians mixed (evo)
  kXy,                  ///< horizontal part of |d| [m] (ov_eval's 2d)
  kYawDeg,              ///< z of the rotation vector of E, signed [deg] (ov_eval's 2d)
  kHeadingDeg,          ///< |yaw| of E = Rz(yaw) Ry(pitch) Rx(roll) [deg] (rpg)
};

/// One value for each pair, in their order.
std::vector<double> absoluteErrors(const AlignedPoses& poses, AbsoluteMeasure measure);

/// Roll, pitch and yaw [deg] of each pose's R = Rz(yaw) Ry(pitch) Rx(roll), as plots over time show
/// them: of all angles that make the same R those nearest to the pose before, so that nothing jumps
/// by a turn. The first: each within 180 degrees, the pitch within 90.
std::vector<Eigen::Vector3d> rollPitchYaw(const std::vector<Transform>& poses);

/// An estimate's, beside `truth_rpy`, those of the truth: nearest to these. Where the rotations
/// differ by more than 45 degrees (median), as of another body frame, what the angles differ by is
/// carried along instead, so that they make no jumps either.
std::vector<Eigen::Vector3d> rollPitchYaw(const AlignedPoses& poses,
                                          const std::vector<Eigen::Vector3d>& truth_rpy);

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

constexpr std::array<const char*, 5> enumWords(RelativePairs /*of*/) {
  return {"plumbline", "evo", "evo-all", "rpg", "ov_eval"};
}

/// A distance over which relative motion is judged.
struct RelativeDelta {
  double delta = 1;
  enum class Unit { kFrames, kMetres, kSeconds } unit = Unit::kMetres;
  RelativePairs pairs = RelativePairs::kPlumbline;
};

/// Whether the tool has such pairs: evo over frames and metres, rpg and ov_eval over metres.
bool hasPairsOver(RelativePairs pairs, RelativeDelta::Unit unit);

constexpr std::array<const char*, 3> enumWords(RelativeDelta::Unit /*of*/) {
  return {"frames", "m", "s"};
}

/// By delta.pairs, which hasPairsOver() delta.unit. This program's pairs are overlapping, from
/// every matched pose. Frames: i to i + delta. Metres and seconds: to the pose whose path along the
/// truth, or whose time, is nearest to delta, and within 10 % of it. `t`: stamps of the pairs.
std::vector<IndexPair> pairsOver(const RelativeDelta& delta, const AlignedPoses& poses,
                                 const std::vector<TimeNs>& t);

/// Statistics of both parts over pairsOver(); n = 0 where the trajectory is shorter than delta.
RelativeErrorRecord relativeErrorOver(const RelativeDelta& delta, const AlignedPoses& poses,
                                      const std::vector<TimeNs>& t);

/// P of an estimate's pose (tangent of Transform) in the truth's frame: B P B^T with
/// B = diag(scale R, R) of the alignment p_truth = scale R p_estimate + t, itself taken as known.
Matrix6d alignedCovariance(const Matrix6d& P, const AlignmentRecord& alignment);

struct Nees {
  std::vector<NeesRecord> parts;  ///< position (3), orientation (3), pose (6)
  std::size_t used = 0;
  std::size_t left_out = 0;  ///< poses whose covariance is not positive definite
};

/// Mean over poses of e^T P^-1 e, with e = boxminus(truth, estimate) and P from `covariances`, one
/// for each pose, in the truth's frame; position and orientation by their own blocks. The bounds
/// hold the mean of n independent consistent poses with 95 %: chi-square quantiles of n dof, over n
/// (Bar-Shalom, Li, Kirubarajan 2001, 5.4.2). Poses of one run err alike for a while, so their mean
/// scatters more than that: a mean just outside is no proof, one far above is overconfidence.
///
/// What is left depends on the alignment: a fit over all poses takes away error that the
/// covariance, which grows from the start, does not expect gone; aligning by the first pose does
/// not.
Nees neesOf(const AlignedPoses& poses, const std::vector<Matrix6d>& covariances);

}  // namespace plumbline
