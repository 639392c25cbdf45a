// SPDX-License-Identifier: BSD-3-Clause
// The block-arrow system against a dense Cholesky of the same matrix, assembled independently.
#include "calibrator/linear/block_arrow.h"

#include <Eigen/Cholesky>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace plumbline {
namespace {

constexpr int kB = kChainBlock;

/// A random positive definite chain: sums of Gram matrices of factors between (i, i + 1, border).
BlockArrow randomChain(int blocks, int border, unsigned seed, int broken_after = -1) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  BlockArrow chain(blocks, border);
  for (int i = 0; i < blocks; ++i) {
    const bool joined = i + 1 < blocks && i != broken_after;
    const int columns = kB + (joined ? kB : 0) + border;
    Eigen::MatrixXd J =
        Eigen::MatrixXd::NullaryExpr(columns + 8, columns + 1, [&] { return normal(engine); });
    const Eigen::MatrixXd G = J.transpose() * J;
    const auto at = static_cast<std::size_t>(i);
    const int b = columns - border;
    chain.diagonal[at] += G.topLeftCorner<kB, kB>();
    chain.to_border[at] += G.block(0, b, kB, border + 1);
    if (joined) {
      chain.next[at] += G.block<kB, kB>(0, kB);
      chain.diagonal[at + 1] += G.block<kB, kB>(kB, kB);
      chain.to_border[at + 1] += G.block(kB, b, kB, border + 1);
    }
    chain.border_block += G.block(b, b, border, border);
    chain.border_gradient += G.block(b, columns, border, 1);
  }
  return chain;
}

struct Dense {
  Eigen::MatrixXd H;
  Eigen::VectorXd b;
};

Dense dense(const BlockArrow& c, double damping) {
  const int n = c.blocks();
  const int m = c.border();
  Dense d{Eigen::MatrixXd::Zero(n * kB + m, n * kB + m), Eigen::VectorXd::Zero(n * kB + m)};
  for (int i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    d.H.block<kB, kB>(i * kB, i * kB) = c.diagonal[at];
    if (i + 1 < n) d.H.block<kB, kB>(i * kB, (i + 1) * kB) = c.next[at];
    d.H.block(i * kB, n * kB, kB, m) = c.to_border[at].leftCols(m);
    d.b.segment<kB>(i * kB) = c.to_border[at].col(m);
  }
  d.H.bottomRightCorner(m, m) = c.border_block;
  d.b.tail(m) = c.border_gradient;
  d.H.diagonal() *= 1 + damping;
  d.H = Eigen::MatrixXd(d.H.selfadjointView<Eigen::Upper>());
  return d;
}

struct Size {
  int blocks;
  int border;
  int broken_after;
};
class BlockArrowSolve : public ::testing::TestWithParam<Size> {};
INSTANTIATE_TEST_SUITE_P(Sizes, BlockArrowSolve,
                         ::testing::Values(Size{1, 9, -1}, Size{2, 9, -1}, Size{3, 1, -1},
                                           Size{8, 9, -1}, Size{9, 31, -1}, Size{9, 9, 3},
                                           Size{10, 9, 4}, Size{10, 9, 5}, Size{4, 0, -1}));

TEST_P(BlockArrowSolve, EqualsADenseCholesky) {
  const auto [blocks, border, broken] = GetParam();
  for (const double damping : {0.0, 0.3}) {
    const BlockArrow chain = randomChain(blocks, border, 11, broken);
    const Dense oracle = dense(chain, damping);
    const Eigen::LLT<Eigen::MatrixXd> llt(oracle.H);
    const Eigen::VectorXd x = -llt.solve(oracle.b);
    const auto solution = solveChain(chain, {damping, 1});
    ASSERT_TRUE(solution);
    const double tolerance = 1e-10 * x.norm();
    for (int i = 0; i < blocks; ++i) {
      EXPECT_LT((solution->step[static_cast<std::size_t>(i)] - x.segment<kB>(i * kB)).norm(),
                tolerance);
    }
    EXPECT_LE((solution->border_step - x.tail(border)).norm(), tolerance);
    EXPECT_NEAR(solution->decrement, -oracle.b.dot(x), 1e-10 * std::abs(oracle.b.dot(x)));
  }
}

TEST_P(BlockArrowSolve, SelectedInverseEqualsADenseInverse) {
  const auto [blocks, border, broken] = GetParam();
  const BlockArrow chain = randomChain(blocks, border, 17, broken);
  const Eigen::MatrixXd H = dense(chain, 0).H;
  const Eigen::MatrixXd S = H.llt().solve(Eigen::MatrixXd::Identity(H.rows(), H.cols()));
  const double tolerance = 1e-11 * S.norm();
  const auto inverse = invertChain(chain);
  ASSERT_TRUE(inverse);
  const ChainCovariance& c = inverse->covariance;
  EXPECT_LE((c.border - S.bottomRightCorner(border, border)).norm(), tolerance);
  for (int i = 0; i < blocks; ++i) {
    const auto at = static_cast<std::size_t>(i);
    EXPECT_LT((c.diagonal[at] - S.block<kB, kB>(i * kB, i * kB)).norm(), tolerance) << i;
    EXPECT_LE((c.to_border[at] - S.block(i * kB, blocks * kB, kB, border)).norm(), tolerance) << i;
    if (i + 1 == blocks) continue;
    EXPECT_LE((c.next[at] - S.block<kB, kB>(i * kB, (i + 1) * kB)).norm(), tolerance) << i;
  }
}

TEST_P(BlockArrowSolve, ResponsesEqualADenseSolution) {
  const auto [blocks, border, broken] = GetParam();
  BlockArrow chain = randomChain(blocks, border, 19, broken);
  const Eigen::MatrixXd H = dense(chain, 0).H;
  const int n = blocks * kB;
  const Eigen::MatrixXd W = -H.topLeftCorner(n, n).llt().solve(H.topRightCorner(n, border));
  chain.border_block.setConstant(std::numeric_limits<double>::quiet_NaN());  // plays no part
  for (const int threads : {1, 2}) {
    const auto responses = chainResponses(chain, threads);
    ASSERT_TRUE(responses);
    for (int i = 0; i < blocks; ++i) {
      const Eigen::MatrixXd& expected = W.middleRows<kB>(i * kB);
      EXPECT_LE(((*responses)[static_cast<std::size_t>(i)] - expected).norm(),
                1e-10 * (1 + W.norm()))
          << i;
    }
  }
}

TEST(BlockArrowInverse, SolvesAsWithoutItAndOnAnyNumberOfThreads) {
  const BlockArrow chain = randomChain(11, 9, 3);
  const auto solution = solveChain(chain);
  const auto one = invertChain(chain);
  const auto two = invertChain(chain, {0, 2});
  ASSERT_TRUE(solution && one && two);
  EXPECT_EQ(one->solution.border_step, solution->border_step);
  EXPECT_EQ(one->solution.step.front(), solution->step.front());
  for (std::size_t i = 0; i < 11; ++i) {
    EXPECT_EQ(one->covariance.diagonal[i], two->covariance.diagonal[i]);
    EXPECT_EQ(one->covariance.next[i], two->covariance.next[i]);
  }
}

TEST_P(BlockArrowSolve, GivesTheMarginalInformationOfTheBorder) {
  const auto [blocks, border, broken] = GetParam();
  const BlockArrow chain = randomChain(blocks, border, 5, broken);
  const Eigen::MatrixXd H = dense(chain, 0).H;
  const Eigen::MatrixXd covariance = H.llt()
                                         .solve(Eigen::MatrixXd::Identity(H.rows(), H.cols()))
                                         .bottomRightCorner(border, border);
  const auto solution = solveChain(chain);
  ASSERT_TRUE(solution);
  EXPECT_LT((solution->border_information * covariance - Eigen::MatrixXd::Identity(border, border))
                .norm(),
            1e-9);
}

TEST(BlockArrow, DoesNotDependOnTheNumberOfThreads) {
  const BlockArrow chain = randomChain(31, 9, 3);
  const auto one = solveChain(chain, {0.1, 1});
  const auto four = solveChain(chain, {0.1, 4});
  ASSERT_TRUE(one && four);
  EXPECT_EQ(one->border_step, four->border_step);
  EXPECT_EQ(one->border_information, four->border_information);
  EXPECT_EQ(one->step, four->step);
  EXPECT_EQ(one->decrement, four->decrement);
}

TEST(BlockArrow, ReadsUpperTrianglesOnly) {
  BlockArrow chain = randomChain(5, 9, 3);
  const auto before = solveChain(chain);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (ChainMatrix& D : chain.diagonal) D.triangularView<Eigen::StrictlyLower>().setConstant(nan);
  chain.border_block.triangularView<Eigen::StrictlyLower>().setConstant(nan);
  const auto after = solveChain(chain);
  ASSERT_TRUE(before && after);
  EXPECT_EQ(before->border_step, after->border_step);
}

TEST(BlockArrow, ReportsAPivotThatIsNotPositive) {
  BlockArrow chain = randomChain(5, 9, 3);
  chain.diagonal[3](7, 7) = -1;
  EXPECT_FALSE(solveChain(chain));
  chain = randomChain(5, 9, 3);
  chain.border_block.setZero();
  EXPECT_FALSE(solveChain(chain));
}

}  // namespace
}  // namespace plumbline
