// SPDX-License-Identifier: BSD-3-Clause
#include "tests/calibrator/oracle/tangent_covariance.h"

#include <stdexcept>

#include <ceres/covariance.h>

namespace plumbline::oracle {

Eigen::MatrixXd tangentCovariance(ceres::Problem& problem, const std::vector<const double*>& blocks,
                                  const std::vector<double>& scale) {
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::SPARSE_QR;
  ceres::Covariance covariance(options);
  if (!covariance.Compute(blocks, &problem)) {
    throw std::runtime_error("the oracle's problem is singular");
  }
  const auto n = static_cast<Eigen::Index>(scale.size());
  const Eigen::Map<const Eigen::VectorXd> scales(scale.data(), n);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> matrix(n, n);
  covariance.GetCovarianceMatrixInTangentSpace(blocks, matrix.data());
  return scales.asDiagonal() * matrix * scales.asDiagonal();
}

}  // namespace plumbline::oracle
