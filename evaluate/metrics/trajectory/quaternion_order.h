// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "evaluate/metrics/trajectory/alignment.h"
#include "evaluate/metrics/trajectory/association.h"

namespace plumbline {

/// How the rotations of aligned poses relate, were the quaternions of one side inverted (world to
/// body, as JPL's are often written): R_truth = R_estimate R_body up to `spread_deg`.
struct BodyRotation {
  bool truth_inverted = false;
  bool estimate_inverted = false;
  double angle_deg = 0;   ///< of R_body, the chordal mean of R_estimate^T R_truth
  double spread_deg = 0;  ///< median angle between R_estimate R_body and R_truth
};

/// The body rotation of these poses under one reading; at least one pose. `R_truth_estimate` is the
/// alignment that `poses` contain, under which an inverted estimate has to be inverted. O(n).
BodyRotation bodyRotation(const AlignedPoses& poses, const Eigen::Matrix3d& R_truth_estimate,
                          bool truth_inverted, bool estimate_inverted);

/// What was read as (x, y, z, w) from a file that has w first: (w, x, y, z) of it.
Eigen::Quaterniond fromWFirst(const Eigen::Quaterniond& read);

/// Quaternions that were read in the wrong order, as two trajectories together tell.
struct QuaternionOrderFault {
  bool estimate = false;     ///< the estimate's may be the wrong ones
  bool truth = false;        ///< the truth's may be; both where positions cannot tell
  double as_read_deg = 0;    ///< median angle to the best constant turn of the body, as read
  double reordered_deg = 0;  ///< and with w first
};

/// Whether w-first quaternions were read as w-last. One file alone cannot tell: w-first read as
/// w-last is the inverse rotation between two constant turns, A R^T B, so all relative angles stay.
/// With the worlds joined by the positions (least squares) the true order leaves a constant turn of
/// the body, the wrong one does not. A fault is one where the other order fits within 5 degrees in
/// the median, three times better than as read and than inverted quaternions would. None where
/// positions do not fix the rotation (a line), or rotations hardly vary. O(n).
std::optional<QuaternionOrderFault> quaternionOrderFault(const std::vector<PosePair>& pairs);

}  // namespace plumbline
