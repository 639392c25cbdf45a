// SPDX-License-Identifier: BSD-3-Clause
// The kernels against Eigen's own products and factors. Only the version that this machine runs is
// tested.
#include <Eigen/Cholesky>
#include <cstdlib>
#include <limits>

#include <gtest/gtest.h>

#include "calibrator/linear/dense.h"

namespace plumbline {
namespace {

constexpr double kTolerance = 1e-13;  // entries are of order 1, sums of at most 24 terms

class RowKernels : public testing::Test {
 protected:
  RowKernels() { std::srand(7); }  // Eigen's Random()
};

Eigen::MatrixXd positive(int n) {
  const Eigen::MatrixXd A = Eigen::MatrixXd::Random(n, 2 * n);
  return A * A.transpose();
}

TEST_F(RowKernels, FactoriseRowsIsCholeskyAndForwardSubstitution) {
  const Eigen::MatrixXd A = positive(6);
  const Eigen::MatrixXd B = Eigen::MatrixXd::Random(6, 12);
  RowMatrix rows = RowMatrix::Zero(6, 20);  // two columns between both fill up the lanes
  rows.leftCols(6) = A.triangularView<Eigen::Upper>();
  rows.rightCols(12) = B;
  ASSERT_TRUE(factoriseRows(rows));
  const Eigen::MatrixXd L = A.llt().matrixL();
  const Eigen::MatrixXd upper = rows.leftCols(6).triangularView<Eigen::Upper>();
  EXPECT_LT((upper - L.transpose()).cwiseAbs().maxCoeff(), kTolerance);
  const Eigen::MatrixXd expected = L.triangularView<Eigen::Lower>().solve(B);
  EXPECT_LT((rows.rightCols(12) - expected).cwiseAbs().maxCoeff(), kTolerance);
  EXPECT_EQ(rows.middleCols(6, 2).cwiseAbs().maxCoeff(), 0);
}

TEST_F(RowKernels, FactoriseRowsRefusesWhatIsNotPositive) {
  RowMatrix rows = RowMatrix::Identity(4, 4);
  rows(2, 2) = -1;
  EXPECT_FALSE(factoriseRows(rows));
  rows = RowMatrix::Identity(4, 4);
  rows(3, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(factoriseRows(rows));
}

TEST_F(RowKernels, AddGramAddsTheUpperTriangle) {
  const RowMatrix rows = RowMatrix::Random(9, 24);
  const RowMatrix before = RowMatrix::Random(20, 20);
  RowMatrix gram = before;
  addGram(rows, 4, gram);
  const RowMatrix P = rows.rightCols(20);
  const RowMatrix error = gram - before - P.transpose() * P;
  const RowMatrix upper = error.triangularView<Eigen::Upper>();
  EXPECT_LT(upper.cwiseAbs().maxCoeff(), kTolerance);
}

TEST_F(RowKernels, SolveUpperUndoesTheProduct) {
  RowMatrix rows = RowMatrix::Random(5, 8);
  rows.diagonal().array() += 3;
  const RowMatrix X = RowMatrix::Random(5, 12);
  const RowMatrix B = rows.leftCols(5).triangularView<Eigen::Upper>() * X;
  EXPECT_LT((solveUpper(rows, B) - X).cwiseAbs().maxCoeff(), kTolerance);
}

TEST_F(RowKernels, ProductOfAnyShape) {
  const RowMatrix A = RowMatrix::Random(7, 5);
  const RowMatrix B = RowMatrix::Random(5, 12);
  EXPECT_LT((product(A, B) - A * B).cwiseAbs().maxCoeff(), kTolerance);
}

}  // namespace
}  // namespace plumbline
