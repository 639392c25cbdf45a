// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/trajectory/nees.h"

#include <Eigen/Cholesky>
#include <cassert>
#include <cmath>

#include <boost/math/distributions/chi_squared.hpp>

namespace plumbline {
namespace {

constexpr double kConfidence = 0.95;

NeesRecord recordOf(const char* part, int dof, double sum, std::size_t count) {
  const auto n = static_cast<double>(count);
  const double tail = (1 - kConfidence) / 2;
  const boost::math::chi_squared sum_of_squares(n * dof);
  NeesRecord record;
  record.part = part;
  record.dof = dof;
  record.mean = sum / n;
  record.lower = boost::math::quantile(sum_of_squares, tail) / n;
  record.upper = boost::math::quantile(boost::math::complement(sum_of_squares, tail)) / n;
  record.confidence = kConfidence;
  if (record.mean > record.upper) record.reading = NeesReading::kOverconfident;
  if (record.mean < record.lower) record.reading = NeesReading::kCautious;
  return record;
}

template <int N>
double normalised(const Eigen::Matrix<double, N, 1>& e, const Eigen::Matrix<double, N, N>& P) {
  return e.dot(P.llt().solve(e));
}

}  // namespace

Matrix6d alignedCovariance(const Matrix6d& P, const AlignmentRecord& alignment) {
  Matrix6d B = Matrix6d::Zero();
  B.topLeftCorner<3, 3>() = alignment.scale * alignment.T_truth_estimate.R;
  B.bottomRightCorner<3, 3>() = alignment.T_truth_estimate.R;
  return B * P * B.transpose();
}

Nees neesOf(const AlignedPoses& poses, const std::vector<Matrix6d>& covariances) {
  assert(covariances.size() == poses.truth.size());
  Nees nees;
  double position = 0, orientation = 0, pose = 0;
  for (std::size_t i = 0; i < poses.truth.size(); ++i) {
    const Matrix6d& P = covariances[i];
    if (!P.allFinite() || P.llt().info() != Eigen::Success) {
      ++nees.left_out;
      continue;
    }
    const Vector6d e = boxminus(poses.truth[i], poses.estimate[i]);
    position += normalised<3>(e.head<3>(), P.topLeftCorner<3, 3>());
    orientation += normalised<3>(e.tail<3>(), P.bottomRightCorner<3, 3>());
    pose += normalised<6>(e, P);
    ++nees.used;
  }
  if (nees.used == 0) return nees;
  nees.parts = {recordOf("position", 3, position, nees.used),
                recordOf("orientation", 3, orientation, nees.used),
                recordOf("pose", 6, pose, nees.used)};
  return nees;
}

}  // namespace plumbline
