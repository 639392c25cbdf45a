// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/dense/decompositions.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace plumbline {
namespace {

/// Q diag(values) Q^T with a Householder reflection Q.
Eigen::MatrixXd matrixOf(const Eigen::VectorXd& values) {
  const Eigen::VectorXd u = Eigen::VectorXd::LinSpaced(values.size(), 1, 2).normalized();
  const Eigen::MatrixXd Q =
      Eigen::MatrixXd::Identity(values.size(), values.size()) - 2 * u * u.transpose();
  return Q * values.asDiagonal() * Q;
}

TEST(SymmetricEigen, FindsTheEigenvaluesAMatrixWasMadeOf) {
  const Eigen::VectorXd values = Eigen::Vector4d(-2, 0, 3, 1e6);
  const Eigen::MatrixXd A = matrixOf(values);
  const SymmetricEigen eigen = symmetricEigen(A);
  EXPECT_LT((eigen.values - values).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_TRUE((eigen.vectors * eigen.vectors.transpose()).isIdentity(1e-12));
  EXPECT_TRUE((eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose()).isApprox(A));
}

TEST(SymmetricFactor, SolvesWhateverTheSignsOfTheEigenvalues) {
  const Eigen::MatrixXd A = matrixOf(Eigen::Vector4d(-2, 0.1, 3, 1e3));
  const SymmetricFactor factor(A);
  ASSERT_TRUE(factor.succeeded());
  EXPECT_FALSE(factor.isPositive() || factor.isPositiveDefinite());
  EXPECT_TRUE(SymmetricFactor(A * A).isPositiveDefinite());
  EXPECT_TRUE((A * factor.inverse()).isIdentity(1e-10));
  const Eigen::MatrixXd B = Eigen::MatrixXd::Random(4, 2);
  EXPECT_TRUE((A * factor.solve(B)).isApprox(B, 1e-10));
  const Eigen::VectorXd b = B.col(0);
  EXPECT_NEAR(factor.squaredNorm(b), b.dot(A.inverse() * b), 1e-10);
  // Determinants of L and P are of size 1.
  EXPECT_NEAR(factor.pivots().prod(), -2 * 0.1 * 3 * 1e3, 1e-8);
}

TEST(SymmetricFactor, TellsAMatrixOfLowRank) {
  const SymmetricFactor rounded(matrixOf(Eigen::Vector3d(0, 1, 2)));
  EXPECT_LT(rounded.pivots().cwiseAbs().minCoeff(), 1e-15);
  const SymmetricFactor exact(Eigen::MatrixXd(Eigen::Vector3d(0, 1, 2).asDiagonal()));
  EXPECT_TRUE(exact.isPositive() && !exact.isPositiveDefinite());
  EXPECT_TRUE(exact.solve(Eigen::Vector3d(5, 3, 4)).isApprox(Eigen::Vector3d(0, 3, 2)));
}

TEST(SymmetricFactor, OnlyTheLowerTriangleIsRead) {
  Eigen::MatrixXd A = matrixOf(Eigen::Vector3d(1, 2, 3));
  const Eigen::MatrixXd inverse = SymmetricFactor(A).inverse();
  A(0, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(SymmetricFactor(A).inverse(), inverse);
}

TEST(LeastSquares, IsTheSolutionOfTheNormalEquations) {
  const Eigen::MatrixXd A = Eigen::MatrixXd::Random(7, 3), B = Eigen::MatrixXd::Random(7, 2);
  const Eigen::MatrixXd X = leastSquares(A, B);
  EXPECT_LT((A.transpose() * (A * X - B)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(LeastSquares, OfSeveralTheShortest) {
  Eigen::MatrixXd A(3, 2);
  A << 1, 1, 2, 2, 3, 3;
  const Eigen::MatrixXd X = leastSquares(A, Eigen::Vector3d(2, 4, 6));
  EXPECT_TRUE(X.isApprox(Eigen::Vector2d(1, 1), 1e-12));
}

// Penrose: A X A = A, X A X = X, both products symmetric.
TEST(SymmetricPseudoInverse, HoldsPenrosesConditionsForASingularMatrix) {
  const Eigen::MatrixXd A = matrixOf(Eigen::Vector4d(0, 0, 3, 8));
  const Eigen::MatrixXd X = symmetricPseudoInverse(A, 1e-12);
  EXPECT_TRUE((A * X * A).isApprox(A, 1e-12));
  EXPECT_TRUE((X * A * X).isApprox(X, 1e-12));
  EXPECT_TRUE((A * X).isApprox((A * X).transpose(), 1e-12));
}

TEST(SymmetricPseudoInverse, IsTheInverseWhereThereIsOne) {
  const Eigen::MatrixXd A = matrixOf(Eigen::Vector3d(1, 3, 8));
  EXPECT_TRUE((symmetricPseudoInverse(A, 1e-12) * A).isIdentity(1e-12));
}

TEST(SymmetricPseudoInverse, LeavesAsZeroWhatIsBelowTheTolerance) {
  const Eigen::MatrixXd A = Eigen::Vector3d(1e-8, 1, 2).asDiagonal();
  EXPECT_EQ(symmetricPseudoInverse(A, 1e-6)(0, 0), 0);
  EXPECT_NEAR(symmetricPseudoInverse(A, 1e-10)(0, 0), 1e8, 1e-4);
  EXPECT_TRUE(symmetricPseudoInverse(Eigen::MatrixXd::Zero(2, 2), 1e-12).isZero(0));
}

TEST(FiniteInverse, IsTheInverseWhateverTheUnits) {
  Eigen::MatrixXd A = matrixOf(Eigen::Vector3d(1, 3, 8));
  const Eigen::Vector3d units(1e-4, 1, 1e5);
  A = (units.asDiagonal() * A * units.asDiagonal()).eval();
  const Eigen::MatrixXd product =
      units.asDiagonal() * finiteInverse(A, 1e-30, 1e-13) * A * units.cwiseInverse().asDiagonal();
  EXPECT_TRUE(product.isIdentity(1e-11));
}

TEST(FiniteInverse, IsFiniteWhereNothingIsKnown) {
  const Eigen::MatrixXd A = Eigen::Vector3d(0, 1e-9, 2).asDiagonal();
  const Eigen::MatrixXd inverse = finiteInverse(A, 1e-6, 1e-3);
  // The least of the diagonal times the prior's share is what is known of the first.
  EXPECT_NEAR(inverse(0, 0), 1e9, 1);
  EXPECT_NEAR(inverse(1, 1), 5e8, 1);
  EXPECT_NEAR(inverse(2, 2), 0.5 / 1.001, 1e-12);
}

}  // namespace
}  // namespace plumbline
