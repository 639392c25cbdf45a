// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/linear/symmetric_eigen.h"

#include <Eigen/Eigenvalues>
#include <cassert>

namespace plumbline {

SymmetricEigen symmetricEigen(const Eigen::MatrixXd& A) {
  assert(A.rows() == A.cols());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(A);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

Eigen::MatrixXd symmetricPseudoInverse(const Eigen::MatrixXd& A, double tolerance) {
  const SymmetricEigen eigen = symmetricEigen(A);
  const double least = tolerance * eigen.values.maxCoeff();
  const Eigen::VectorXd inverse =
      eigen.values.unaryExpr([least](double value) { return value > least ? 1 / value : 0.0; });
  return eigen.vectors * inverse.asDiagonal() * eigen.vectors.transpose();
}

}  // namespace plumbline
