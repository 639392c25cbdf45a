// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace plumbline {

// Decompositions of matrices of any size, compiled once: for each size of its own Eigen makes
// hundreds of functions of them, a second or two of every compiler that sees one. What is solved
// for every corner or feature keeps its size.

/// A = P^T L D L^T P of a symmetric n x n matrix, the largest pivot first.
class SymmetricFactor {
 public:
  /// Reads the lower triangle of A.
  explicit SymmetricFactor(const Eigen::MatrixXd& A);

  /// A^-1 B, n x m. A pivot that is zero gives zero; one that is left of rounding counts as any
  /// other: ask pivots().
  Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;
  /// A^-1.
  Eigen::MatrixXd inverse() const;
  /// b^T A^-1 b.
  double squaredNorm(const Eigen::VectorXd& b) const;

  bool succeeded() const { return ldlt_.info() == Eigen::Success; }
  /// Every pivot is above zero.
  bool isPositiveDefinite() const { return succeeded() && pivots().minCoeff() > 0; }
  /// No pivot is negative.
  bool isPositive() const { return ldlt_.isPositive(); }
  /// Of D, in the order of the pivots.
  Eigen::VectorXd pivots() const { return ldlt_.vectorD(); }

 private:
  Eigen::LDLT<Eigen::MatrixXd> ldlt_;
};

/// The X (n x k) of least |A X - B| for A (m x n) of any rank; of several the shortest.
Eigen::MatrixXd leastSquares(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// A = V diag(values) V^T of a symmetric n x n matrix.
struct SymmetricEigen {
  Eigen::VectorXd values;   ///< ascending
  Eigen::MatrixXd vectors;  ///< V: orthonormal columns in the order of values
};

/// Reads the lower triangle of A, whose entries are finite.
SymmetricEigen symmetricEigen(const Eigen::MatrixXd& A);

/// The Moore-Penrose inverse of a symmetric positive semi-definite matrix: eigenvalues up to
/// `tolerance` times the largest count as zero, and the directions they belong to stay zero in
/// every solution. Zero for a zero matrix.
Eigen::MatrixXd symmetricPseudoInverse(const Eigen::MatrixXd& A, double tolerance);

/// Inverse of a symmetric positive semi-definite matrix of mixed units, always finite: A is scaled
/// to a unit diagonal, entries of the diagonal below `least` as if they were that, and there
/// `prior` is added to the diagonal, a share far below what is measured. Symmetric to the last bit.
Eigen::MatrixXd finiteInverse(const Eigen::MatrixXd& A, double least, double prior);

}  // namespace plumbline
