// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/trajectory/body_frame.h"

#include <numbers>
#include <utility>

#include "calibrator/base/lie.h"
#include "calibrator/base/sample_statistics.h"

namespace plumbline {

BodyRotation bodyRotation(const AlignedPoses& poses, const Eigen::Matrix3d& R_truth_estimate,
                          bool truth_inverted, bool estimate_inverted) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  std::vector<Eigen::Matrix3d> relative;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < poses.truth.size(); ++i) {
    Eigen::Matrix3d R_truth = poses.truth[i].R;
    if (truth_inverted) R_truth.transposeInPlace();
    Eigen::Matrix3d R_estimate = R_truth_estimate.transpose() * poses.estimate[i].R;
    if (estimate_inverted) R_estimate.transposeInPlace();
    relative.emplace_back((R_truth_estimate * R_estimate).transpose() * R_truth);
    sum += relative.back();
  }
  const Eigen::Matrix3d R_body = nearestRotation(sum);
  std::vector<double> angles;
  for (const Eigen::Matrix3d& R : relative) {
    angles.push_back(kDegrees * rotationAngle(R_body.transpose() * R));
  }
  return {truth_inverted, estimate_inverted, kDegrees * rotationAngle(R_body),
          sampleStatistics(std::move(angles)).median};
}

}  // namespace plumbline
