// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/trajectory/quaternion_order.h"

#include <algorithm>
#include <utility>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"
#include "evaluate/metrics/trajectory/alignment.h"

namespace plumbline {
namespace {

// A spread below it is that of estimates in order; another order has to fit as well as that, and by
// the factor below better than all other readings.
constexpr double kUnsuspicious = 5;  // [deg]
constexpr double kClearly = 3;

std::vector<PosePair> reordered(std::vector<PosePair> pairs, StampedPose PosePair::*side) {
  for (PosePair& pair : pairs) (pair.*side).q = fromWFirst((pair.*side).q);
  return pairs;
}

/// Of pairs whose quaternions were reordered; the alignment by positions stays right.
double spreadOf(const std::vector<PosePair>& pairs, const AlignmentRecord& alignment) {
  return bodyRotation(alignedPoses(pairs, alignment), alignment.T_truth_estimate.R, false, false)
      .spread_deg;
}

}  // namespace

BodyRotation bodyRotation(const AlignedPoses& poses, const Eigen::Matrix3d& R_truth_estimate,
                          bool truth_inverted, bool estimate_inverted) {
  std::vector<Eigen::Matrix3d> relative;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  // An inverted estimate has to be inverted in its own world, so the alignment is taken off it and
  // put back on.
  for (std::size_t i = 0; i < poses.truth.size(); ++i) {
    Eigen::Matrix3d R_truth = poses.truth[i].R;
    if (truth_inverted) R_truth.transposeInPlace();
    Eigen::Matrix3d R_estimate = R_truth_estimate.transpose() * poses.estimate[i].R;
    if (estimate_inverted) R_estimate.transposeInPlace();
    relative.emplace_back((R_truth_estimate * R_estimate).transpose() * R_truth);
    sum += relative.back();
  }
  // The chordal mean: the rotation nearest to the sum.
  const Eigen::Matrix3d R_body = nearestRotation(sum);
  std::vector<double> angles;
  for (const Eigen::Matrix3d& R : relative) {
    angles.push_back(kDegrees * rotationAngle(R_body.transpose() * R));
  }
  return {truth_inverted, estimate_inverted, kDegrees * rotationAngle(R_body),
          sampleStatistics(std::move(angles)).median};
}

Eigen::Quaterniond fromWFirst(const Eigen::Quaterniond& read) {
  return {read.x(), read.y(), read.z(), read.w()};
}

std::optional<QuaternionOrderFault> quaternionOrderFault(const std::vector<PosePair>& pairs) {
  // With scale: a monocular estimate has none of its own, and R does not depend on it.
  const Result<AlignmentRecord> joined = align(pairs, {AlignmentKind::kSim3});
  if (!joined) return std::nullopt;
  const AlignedPoses poses = alignedPoses(pairs, *joined);
  const Eigen::Matrix3d& R = joined->T_truth_estimate.R;
  const double as_read = bodyRotation(poses, R, false, false).spread_deg;
  if (as_read < kUnsuspicious) return std::nullopt;
  const double inverted = std::min(bodyRotation(poses, R, true, false).spread_deg,
                                   bodyRotation(poses, R, false, true).spread_deg);
  // Better than as read and than with inverted quaternions, which is the likelier mistake.
  const double limit = std::min(kUnsuspicious, std::min(as_read, inverted) / kClearly);
  const double estimate = spreadOf(reordered(pairs, &PosePair::estimate), *joined);
  const double truth = spreadOf(reordered(pairs, &PosePair::truth), *joined);
  if (std::min(estimate, truth) >= limit) return std::nullopt;
  return QuaternionOrderFault{estimate < limit, truth < limit, as_read, std::min(estimate, truth)};
}

}  // namespace plumbline
