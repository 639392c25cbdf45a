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

Eigen::MatrixXd leastSquares(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  assert(A.rows() == B.rows());
  return A.completeOrthogonalDecomposition().solve(B);
}

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

Eigen::MatrixXd finiteInverse(const Eigen::MatrixXd& A, double least, double prior) {
  assert(A.rows() == A.cols());
  const Eigen::VectorXd scale = A.diagonal().cwiseMax(least).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = scale.asDiagonal() * A * scale.asDiagonal();
  scaled.diagonal().array() += prior;
  const Eigen::MatrixXd inverse = SymmetricFactor(scaled).inverse();
  const Eigen::MatrixXd out = scale.asDiagonal() * inverse * scale.asDiagonal();
  return 0.5 * (out + out.transpose());
}

}  // namespace plumbline
