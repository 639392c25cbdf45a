// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrator/base/statistics/estimated_variance.h"

namespace plumbline {

/// Degrees of freedom of cluster-robust variances (calibrator/information/cluster_robust.h). That
/// of a combination l' p of the parameters is a sum over blocks,
///   v = sum_b (a_b' s_b)^2,   a_b = A_b l,
/// of scores s_b that have under white noise the covariance G_b where b = c less G_b G_c, G_b the
/// blocks' leverage in whitened parameters: that of a_b' s_b is W, and (Satterthwaite 1946)
///   dof = tr(W)^2 / tr(W^2).
struct ClusterDegrees {
  std::vector<Eigen::MatrixXd> adjustment;  ///< A_b
  std::vector<Eigen::MatrixXd> leverage;    ///< G_b

  double of(const Eigen::VectorXd& combination) const;
};

/// Cluster-robust ("sandwich") covariance of the cameras' parameters and the board's terms
/// (calibrator/batch/camera/robust_covariance.h).
struct RobustCovariance {
  Eigen::MatrixXd matrix;         ///< in the order of CameraLayout
  Eigen::MatrixXd known;          ///< what of it no block tells: a known board's; empty: nothing
  ClusterDegrees degrees;         ///< of the rest
  int blocks = 0;                 ///< M: the rest has rank M - 1 at most
  double correlation_frames = 1;  ///< correlation length of the scores [frames]

  /// Of a combination l' p of the parameters.
  EstimatedVariance variance(const Eigen::VectorXd& combination) const;
  /// Of the first `count` parameters.
  RobustDeviations deviations(Eigen::Index count) const;
};

}  // namespace plumbline
