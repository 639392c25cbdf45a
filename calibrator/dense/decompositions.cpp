// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/dense/decompositions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cassert>

namespace plumbline {

SymmetricFactor::SymmetricFactor(const Eigen::MatrixXd& A) : ldlt_(A) {
  assert(A.rows() == A.cols());
}

Eigen::MatrixXd SymmetricFactor::solve(const Eigen::MatrixXd& B) const { return ldlt_.solve(B); }

Eigen::MatrixXd SymmetricFactor::inverse() const {
  return solve(Eigen::MatrixXd::Identity(ldlt_.rows(), ldlt_.cols()));
}

double SymmetricFactor::squaredNorm(const Eigen::VectorXd& b) const {
  return b.dot(solve(b).col(0));
}

double SymmetricFactor::rcond() const { return ldlt_.rcond(); }

Eigen::MatrixXd leastSquares(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  assert(A.rows() == B.rows());
  return A.completeOrthogonalDecomposition().solve(B);
}

SymmetricEigen symmetricEigen(const Eigen::MatrixXd& A) {
  assert(A.rows() == A.cols());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(A);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

}  // namespace plumbline
