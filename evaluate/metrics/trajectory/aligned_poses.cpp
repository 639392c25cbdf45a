// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/trajectory/aligned_poses.h"

namespace plumbline {

AlignedPoses alignedPoses(const std::vector<PosePair>& pairs, const AlignmentRecord& alignment,
                          QuaternionUse use) {
  const Transform& T = alignment.T_truth_estimate;
  const Eigen::Quaterniond q = shepperdQuaternion(T.R);
  AlignedPoses aligned;
  aligned.truth.reserve(pairs.size());
  aligned.estimate.reserve(pairs.size());
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d p = alignment.scale * (T.R * pair.estimate.p) + T.t;
    aligned.truth.emplace_back(rotationOf(pair.truth.q, use), pair.truth.p);
    aligned.estimate.emplace_back(rotationOf(q * pair.estimate.q, QuaternionUse::kNormalised), p);
  }
  return aligned;
}

}  // namespace plumbline
