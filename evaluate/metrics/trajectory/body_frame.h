// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "evaluate/metrics/trajectory/aligned_poses.h"

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

}  // namespace plumbline
