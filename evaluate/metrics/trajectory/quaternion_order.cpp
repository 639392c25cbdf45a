// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/trajectory/quaternion_order.h"

#include <algorithm>

#include "evaluate/metrics/trajectory/aligned_poses.h"
#include "evaluate/metrics/trajectory/alignment.h"
#include "evaluate/metrics/trajectory/body_frame.h"

namespace plumbline {
namespace {

constexpr double kUnsuspicious = 5;  // [deg]
constexpr double kClearly = 3;

std::vector<PosePair> reordered(std::vector<PosePair> pairs, StampedPose PosePair::*side) {
  for (PosePair& pair : pairs) (pair.*side).q = fromWFirst((pair.*side).q);
  return pairs;
}

double spreadOf(const std::vector<PosePair>& pairs, const AlignmentRecord& alignment) {
  return bodyRotation(alignedPoses(pairs, alignment), alignment.T_truth_estimate.R, false, false)
      .spread_deg;
}

}  // namespace

Eigen::Quaterniond fromWFirst(const Eigen::Quaterniond& read) {
  return {read.x(), read.y(), read.z(), read.w()};
}

std::optional<QuaternionOrderFault> quaternionOrderFault(const std::vector<PosePair>& pairs) {
  const Result<AlignmentRecord> joined = align(pairs, {AlignmentKind::kSim3});
  if (!joined) return std::nullopt;
  const AlignedPoses poses = alignedPoses(pairs, *joined);
  const Eigen::Matrix3d& R = joined->T_truth_estimate.R;
  const double as_read = bodyRotation(poses, R, false, false).spread_deg;
  if (as_read < kUnsuspicious) return std::nullopt;
  const double inverted = std::min(bodyRotation(poses, R, true, false).spread_deg,
                                   bodyRotation(poses, R, false, true).spread_deg);
  const double limit = std::min(kUnsuspicious, std::min(as_read, inverted) / kClearly);
  const double estimate = spreadOf(reordered(pairs, &PosePair::estimate), *joined);
  const double truth = spreadOf(reordered(pairs, &PosePair::truth), *joined);
  if (std::min(estimate, truth) >= limit) return std::nullopt;
  return QuaternionOrderFault{estimate < limit, truth < limit, as_read, std::min(estimate, truth)};
}

}  // namespace plumbline
