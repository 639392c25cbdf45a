// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/trajectory/similarity.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

namespace plumbline {

Similarity bestSimilarity(const PointMoments& moments) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(moments.covariance_yx,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d& U = svd.matrixU();
  const Eigen::Matrix3d& V = svd.matrixV();
  const Eigen::Vector3d& d = svd.singularValues();
  const double handed = U.determinant() * V.determinant() < 0 ? -1 : 1;
  Similarity best;
  best.R = U * Eigen::Vector3d(1, 1, handed).asDiagonal() * V.transpose();
  if (d[0] > 0) best.across = d[1] / d[0];
  if (moments.variance_x > 0) best.scale = (d[0] + d[1] + handed * d[2]) / moments.variance_x;
  return best;
}

BestYaw bestYaw(const Eigen::Matrix3d& C) {
  const double sine = C(1, 0) - C(0, 1);
  const double cosine = C(0, 0) + C(1, 1);
  return {std::atan2(sine, cosine), std::hypot(sine, cosine)};
}

}  // namespace plumbline
