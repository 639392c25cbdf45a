// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace plumbline {

/// Sums over pairs of points (x, y) that every alignment by positions needs.
struct PointMoments {
  Eigen::Vector3d mean_x = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_y = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_yx = Eigen::Matrix3d::Zero();  ///< mean of (y - mean)(x - mean)^T
  double variance_x = 0;                                    ///< mean of |x - mean|^2
  double variance_y = 0;
};

/// The proper rotation R and the factor c that minimise sum |y - (c R x + t)|^2 with
/// t = mean_y - c R mean_x (Umeyama, PAMI 1991, eqs. 40-42). `across` is the second singular value
/// of covariance_yx over the first: where it is zero the points of x or y lie on a line and R is
/// not unique.
struct Similarity {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  double scale = 1;
  double across = 0;
};

Similarity bestSimilarity(const PointMoments& moments);

/// The angle [rad] about z that minimises sum |y - (Rz x + t)|^2: it maximises tr(Rz^T C) for
/// C = covariance_yx (Zhang and Scaramuzza, IROS 2018, eqs. 17 and 18). `strength` is the maximum
/// of that trace's horizontal part; zero where no horizontal direction tells the angle.
struct BestYaw {
  double yaw = 0;
  double strength = 0;
};

BestYaw bestYaw(const Eigen::Matrix3d& C);

}  // namespace plumbline
