// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace plumbline {

/// Summary of the reprojection errors e [px] of a set of corners. Every tool prints another one of
/// these, so all are kept.
struct ErrorStatistics {
  double rmse_px = 0;    ///< sqrt(mean(|e|^2)) over corners
  double mean_px = 0;    ///< mean of |e|
  double median_px = 0;  ///< median of |e|
  double std_px = 0;     ///< standard deviation of |e| (divisor n); rmse^2 = mean^2 + std^2
  Eigen::Vector2d axis_mean_px = Eigen::Vector2d::Zero();  ///< mean of e_u, e_v
  Eigen::Vector2d axis_std_px = Eigen::Vector2d::Zero();   ///< std of e_u, e_v (divisor n)
  std::size_t count = 0;                                   ///< corners
};

/// Statistics of the given errors; all zero for none. Takes a copy because the median reorders.
ErrorStatistics summariseErrors(const std::vector<Eigen::Vector2d>& errors);

/// The q-quantile (0 <= q <= 1) of values by linear interpolation (type 7); values must not be
/// empty.
double quantile(std::vector<double> values, double q);

}  // namespace plumbline
