// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace plumbline {

/// A = V diag(values) V^T of a symmetric n x n matrix.
struct SymmetricEigen {
  Eigen::VectorXd values;   ///< ascending
  Eigen::MatrixXd vectors;  ///< V: orthonormal columns in the order of values
};

/// Reads the lower triangle of A, whose entries are finite. For matrices of any size but the
/// smallest: they are compiled once, here.
SymmetricEigen symmetricEigen(const Eigen::MatrixXd& A);

/// The Moore-Penrose inverse of a symmetric positive semi-definite matrix: eigenvalues up to
/// `tolerance` times the largest count as zero, and the directions they belong to stay zero in
/// every solution. Zero for a zero matrix.
Eigen::MatrixXd symmetricPseudoInverse(const Eigen::MatrixXd& A, double tolerance);

}  // namespace plumbline
