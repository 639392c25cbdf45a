// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/transform.h"
#include "evaluate/metrics/trajectory/association.h"
#include "evaluate/metrics/trajectory/quaternion_use.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

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
