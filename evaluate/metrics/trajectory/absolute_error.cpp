// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/trajectory/absolute_error.h"

#include <cmath>
#include <numbers>

#include "evaluate/metrics/trajectory/quaternion_use.h"

namespace plumbline {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

double errorOf(const Transform& estimate, const Transform& truth, AbsoluteMeasure measure) {
  const Eigen::Vector3d d = estimate.t - truth.t;
  if (measure == AbsoluteMeasure::kTranslation) return d.norm();
  if (measure == AbsoluteMeasure::kXy) return d.head<2>().norm();
  const Eigen::Matrix3d E = estimate.R * truth.R.transpose();
  switch (measure) {
    case AbsoluteMeasure::kRotationPart:
      return (E - Eigen::Matrix3d::Identity()).norm();
    case AbsoluteMeasure::kFullTransformation:
      return std::hypot((E - Eigen::Matrix3d::Identity()).norm(), d.norm());
    case AbsoluteMeasure::kYawDeg:
      return kDegrees * rotationVector(E).z();
    case AbsoluteMeasure::kHeadingDeg:
      return kDegrees * std::abs(std::atan2(E(1, 0), E(0, 0)));
    default:
      return kDegrees * rotationVector(E).norm();
  }
}

}  // namespace

std::vector<double> absoluteErrors(const AlignedPoses& poses, AbsoluteMeasure measure) {
  std::vector<double> errors;
  errors.reserve(poses.truth.size());
  for (std::size_t i = 0; i < poses.truth.size(); ++i) {
    errors.push_back(errorOf(poses.estimate[i], poses.truth[i], measure));
  }
  return errors;
}

}  // namespace plumbline
