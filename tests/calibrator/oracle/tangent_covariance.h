// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include <ceres/problem.h>

namespace plumbline::oracle {

/// Covariance of the blocks in their tangent spaces, stacked, its rows and columns multiplied by
/// `scale`: a pose block's tangent is (dt, da / 2), so that 2 makes radians of its rotation. Throws
/// std::runtime_error for a singular problem.
Eigen::MatrixXd tangentCovariance(ceres::Problem& problem, const std::vector<const double*>& blocks,
                                  const std::vector<double>& scale);

}  // namespace plumbline::oracle
