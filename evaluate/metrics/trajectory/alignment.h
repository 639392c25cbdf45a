// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "calibrator/base/enum_words.h"
#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "evaluate/metrics/trajectory/association.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

/// What is done with quaternions whose length is not exactly one, such as those of a text file.
enum class QuaternionUse {
  kNormalised,  ///< made unit first; every result is of a rotation
  kAsRead,      ///< put into the formula for unit ones as they are, as ov_eval does
};

/// R(q) = (2 w^2 - 1) I + 2 w [v]x + 2 v v^T of the Hamilton quaternion (w, v). With kAsRead and a
/// length of 1 + e this is a rotation only up to terms of order e.
Eigen::Matrix3d rotationOf(const Eigen::Quaterniond& q, QuaternionUse use);

/// The unit quaternion of R by Shepperd's method: the largest of its components from the diagonal,
/// the others divided by it. Where R is not exactly a rotation the choice of the component shows,
/// so ov_eval's figures need this very one.
Eigen::Quaterniond shepperdQuaternion(const Eigen::Matrix3d& R);

/// The rotation vector [rad] as theta / (2 sin theta) (R - R^T)^v with theta = acos((tr R - 1) /
/// 2), and its series near zero: exact to rounding for rotations up to 0.01 rad below pi (beyond,
/// by way of the quaternion), and for matrices that are nearly rotations the value that ov_eval
/// gives.
Eigen::Vector3d rotationVector(const Eigen::Matrix3d& R);

/// The family from which p_truth = s R p_estimate + t is taken.
enum class AlignmentKind {
  kSe3,       ///< R and t by least squares over positions, s = 1
  kSim3,      ///< s, R and t by least squares over positions
  kScale,     ///< s of kSim3 alone; R = I, t = 0
  kYaw,       ///< R about z and t by least squares over positions (posyaw), s = 1
  kOrigin,    ///< the first pair's poses coincide (evo's name for kSe3First)
  kSe3First,  ///< the first pair's poses coincide
  kYawFirst,  ///< the first pair's positions coincide, its rotations as well as a turn about z can
  kNone,      ///< s = 1, R = I, t = 0
};

constexpr std::array<const char*, 8> enumWords(AlignmentKind /*of*/) {
  return {"se3", "sim3", "scale", "yaw", "origin", "se3-first", "yaw-first", "none"};
}

/// Whether the alignment estimates s: lengths of the estimate are then not known beforehand.
inline bool scaleIsUnknown(AlignmentKind kind) {
  return kind == AlignmentKind::kSim3 || kind == AlignmentKind::kScale;
}

struct AlignmentOptions {
  AlignmentKind kind = AlignmentKind::kSe3;
  /// Pairs from the start that the alignment stands on; 0: all. kOrigin, kSe3First and kYawFirst
  /// stand on the first pair in any case, kNone on none.
  int first_n = 0;
  /// Matters to kOrigin, kSe3First and kYawFirst alone; with kAsRead R may be no exact rotation.
  QuaternionUse quaternions = QuaternionUse::kNormalised;
};

/// The alignment of `pairs` under `options`. Fails with kNotObservable where it is not unique:
/// fewer than three pairs for a fit, positions on a line (kSe3, kSim3; the spread across it below
/// 1e-5 of that along it), an estimate that stands still (kScale), no horizontal motion (kYaw), a
/// first rotation that yaw cannot be read from (kYawFirst), no pair at all. O(n).
Result<AlignmentRecord> align(const std::vector<PosePair>& pairs, const AlignmentOptions& options);

/// Matched poses in the truth's frame, index by index.
struct AlignedPoses {
  std::vector<Transform> truth;
  std::vector<Transform> estimate;
};

/// The pairs with the estimate brought into the truth's frame: p = s R_a p_e + t, R = R_a R_e. With
/// kAsRead as ov_eval has it: the truth's quaternions as they are, the estimate's product with
/// R_a's quaternion normalised.
AlignedPoses alignedPoses(const std::vector<PosePair>& pairs, const AlignmentRecord& alignment,
                          QuaternionUse use = QuaternionUse::kNormalised);

}  // namespace plumbline
