// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "calibrator/linear/dense.h"

namespace plumbline {
namespace {

/// Q diag(values) Q^T with a Householder reflection Q.
Eigen::MatrixXd matrixWith(const Eigen::VectorXd& values) {
  const Eigen::VectorXd u = Eigen::VectorXd::LinSpaced(values.size(), 1, 2).normalized();
  const Eigen::MatrixXd Q =
      Eigen::MatrixXd::Identity(values.size(), values.size()) - 2 * u * u.transpose();
  return Q * values.asDiagonal() * Q;
}

// Penrose: A X A = A, X A X = X, both products symmetric.
TEST(SymmetricPseudoInverse, HoldsPenrosesConditionsForASingularMatrix) {
  const Eigen::MatrixXd A = matrixWith(Eigen::Vector4d(0, 0, 3, 8));
  const Eigen::MatrixXd X = symmetricPseudoInverse(A, 1e-12);
  EXPECT_TRUE((A * X * A).isApprox(A, 1e-12));
  EXPECT_TRUE((X * A * X).isApprox(X, 1e-12));
  EXPECT_TRUE((A * X).isApprox((A * X).transpose(), 1e-12));
}

TEST(SymmetricPseudoInverse, IsTheInverseWhereThereIsOne) {
  const Eigen::MatrixXd A = matrixWith(Eigen::Vector3d(1, 3, 8));
  EXPECT_TRUE((symmetricPseudoInverse(A, 1e-12) * A).isIdentity(1e-12));
}

TEST(SymmetricPseudoInverse, LeavesAsZeroWhatIsBelowTheTolerance) {
  const Eigen::MatrixXd A = Eigen::Vector3d(1e-8, 1, 2).asDiagonal();
  EXPECT_EQ(symmetricPseudoInverse(A, 1e-6)(0, 0), 0);
  EXPECT_NEAR(symmetricPseudoInverse(A, 1e-10)(0, 0), 1e8, 1e-4);
  EXPECT_TRUE(symmetricPseudoInverse(Eigen::MatrixXd::Zero(2, 2), 1e-12).isZero(0));
}

TEST(FiniteInverse, IsTheInverseWhateverTheUnits) {
  Eigen::MatrixXd A = matrixWith(Eigen::Vector3d(1, 3, 8));
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
