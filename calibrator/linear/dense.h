// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <optional>
#include <vector>

namespace plumbline {

/// Small dense algebra on rows of doubles whose number of columns is a multiple of kRowLanes.
/// Compiled for plain x86-64 and for AVX2 with fused multiply-add; the machine decides when the
/// program starts. Both agree to rounding.
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
inline constexpr int kRowLanes = 4;

/// (A | B) becomes L^-1 (A | B) = (L' | L^-1 B) with A = L L', n x n, the first n columns of n
/// rows; of A the upper triangle is read, and below it stands nothing of use afterwards. False
/// where a pivot is not positive.
[[nodiscard]] bool factoriseRows(RowMatrix& rows);

/// gram += P' P, upper triangle (and what shares lanes with it), P the columns of `rows` from
/// `first` (a multiple of kRowLanes) on.
void addGram(const RowMatrix& rows, int first, RowMatrix& gram);

/// U^-1 B, U the upper triangle of the first columns of `rows`, n x n, and B n x k.
RowMatrix solveUpper(const RowMatrix& rows, RowMatrix B);

/// A B, with any number of rows and columns of A.
RowMatrix product(const RowMatrix& A, const RowMatrix& B);

/// A quadratic cost about a point, of the displacement d from it:
///   f(d) = c + b^T d + 0.5 d^T H d,   H (n x n) symmetric, b its gradient at the point.
/// As normal equations of least squares, H is the information and the minimum is at H d = -b.
struct QuadraticCost {
  Eigen::MatrixXd H;
  Eigen::VectorXd b;
  double c = 0;
  /// Variance of b by the noise of some of the measurements (n x n); empty: not followed.
  Eigen::MatrixXd noise{};

  /// The same quadratic about the point at displacement d: value f(d), gradient b + H d, H.
  QuadraticCost at(const Eigen::VectorXd& d) const;
  /// In other coordinates x of the displacement, J = dd/dx at the point: J^T H J, J^T b and
  /// J^T noise J.
  QuadraticCost through(const Eigen::MatrixXd& J) const;
};

/// A = D L L^T D of a symmetric positive definite n x n matrix, D diagonal. It is scaled to a
/// unit diagonal before it is factored: pixels beside radians then do not look like a loss of rank.
struct ScaledCholesky {
  Eigen::VectorXd D;                ///< square roots of A's diagonal
  Eigen::LLT<Eigen::MatrixXd> llt;  ///< of D^-1 A D^-1: L
};

/// Reads the lower triangle of A. Empty where A is not positive definite to working precision: a
/// pivot of the scaled matrix, the share of a parameter's information that is its own, is below
/// 1e-13; or where an entry is not finite.
std::optional<ScaledCholesky> scaledCholesky(const Eigen::MatrixXd& A);

/// The cost that remains of `cost` once the parameters that are not in `keep` are at their best:
///   min over d_drop of f = c' + b'^T d_keep + 0.5 d_keep^T H' d_keep,
///   H' = H_kk - H_kd H_dd^-1 H_dk,   b' = b_k - H_kd H_dd^-1 b_d,
///   c' = c - 0.5 b_d^T H_dd^-1 b_d                                (Schur complement),
///   noise' = T noise T^T,   T = (I, -H_kd H_dd^-1)                 (as b' follows b).
/// For a Gaussian, H' is the information of the parameters kept, the others marginalised: H'^-1 is
/// H^-1 without the rows and columns dropped. `keep` lists distinct indices below n, in the order
/// that H' shall have; H' is symmetric to the last bit. Only the lower triangle of H_dd is read.
/// Empty where scaledCholesky() of H_dd is: the parameters dropped are not determined.
std::optional<QuadraticCost> marginalised(const QuadraticCost& cost, const std::vector<int>& keep);

}  // namespace plumbline
