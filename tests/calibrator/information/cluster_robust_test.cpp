// SPDX-License-Identifier: BSD-3-Clause
// The cluster-robust covariance of a linear model by blocks that are few and unlike.
#include "calibrator/information/cluster_robust.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace plumbline {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kParameters = 3;
constexpr int kBlocks = 7;
constexpr int kRows = 4;  // of a block

/// Designs of the blocks, the first of which says most of the first parameter.
std::vector<MatrixXd> designs() {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::vector<MatrixXd> X;
  for (int b = 0; b < kBlocks; ++b) {
    X.push_back(MatrixXd::NullaryExpr(kRows, kParameters, [&] { return normal(random); }));
    X.back().col(1) *= 1e-3;  // of another unit
  }
  X.front().col(0) *= 4;
  return X;
}

MatrixXd regressionCovariance(const std::vector<MatrixXd>& X) {
  MatrixXd S = MatrixXd::Zero(kParameters, kParameters);
  for (const MatrixXd& x : X) S += x.transpose() * x;
  return S.inverse();
}

/// Scores at the least squares solution of data that are noise alone.
BlockScores drawn(const std::vector<MatrixXd>& X, const MatrixXd& covariance,
                  std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<VectorXd> y;
  VectorXd gradient = VectorXd::Zero(kParameters);
  for (const MatrixXd& x : X) {
    y.emplace_back(VectorXd::NullaryExpr(kRows, [&] { return normal(random); }));
    gradient += x.transpose() * y.back();
  }
  const VectorXd estimate = covariance * gradient;
  BlockScores out{MatrixXd(kParameters, kBlocks), {}};
  for (std::size_t b = 0; b < X.size(); ++b) {
    out.scores.col(static_cast<Eigen::Index>(b)) = X[b].transpose() * (y[b] - X[b] * estimate);
    out.information.emplace_back(X[b].transpose() * X[b]);
  }
  return out;
}

VectorXd dofOf(const ClusterRobust& robust) {
  VectorXd out(robust.matrix.rows());
  for (Eigen::Index k = 0; k < out.size(); ++k) {
    out(k) = robust.degrees.of(VectorXd::Unit(out.size(), k));
  }
  return out;
}

TEST(ClusterRobust, IsTheFormalCovarianceInTheMeanOfWhiteNoise) {
  constexpr int kDraws = 20000;
  const auto X = designs();
  const MatrixXd S = regressionCovariance(X);
  std::mt19937_64 random(1);
  MatrixXd mean = MatrixXd::Zero(kParameters, kParameters);
  VectorXd variance = VectorXd::Zero(kParameters);
  VectorXd plain = variance;
  VectorXd dof;
  for (int draw = 0; draw < kDraws; ++draw) {
    const BlockScores blocks = drawn(X, S, random);
    const ClusterRobust robust = clusterRobust(blocks, S);
    mean += robust.matrix / kDraws;
    variance += robust.matrix.diagonal().cwiseAbs2() / kDraws;
    const MatrixXd half = S * blocks.scores;
    plain += (half * half.transpose()).diagonal() / kDraws * kBlocks / (kBlocks - 1.0);
    if (draw == 0) dof = dofOf(robust);
  }
  const VectorXd ratio = mean.diagonal().cwiseQuotient(S.diagonal());
  variance -= mean.diagonal().cwiseAbs2();
  for (int k = 0; k < kParameters; ++k) {
    EXPECT_NEAR(ratio(k), 1, 0.03) << k;
    // A chi-square over its degrees of freedom varies by 2 / dof.
    const double seen = 2 * mean(k, k) * mean(k, k) / variance(k);
    EXPECT_NEAR(dof(k) / seen, 1, 0.1) << k;
    EXPECT_LT(dof(k), kBlocks);
  }
  EXPECT_LT(plain(0) / S(0, 0),
            0.8);  // the block that says most hides its errors from the plain one
  EXPECT_LT((mean - S).cwiseAbs().maxCoeff(), 0.03 * S.cwiseAbs().maxCoeff());
}

// A mean of blocks that say equally much of one parameter: chi-square with one degree less than
// blocks, whatever the unit; blocks that are joined have fewer.
TEST(ClusterRobust, EqualBlocksHaveOneDegreeOfFreedomLessThanThereAre) {
  for (const int blocks : {2, 6, 20}) {
    const BlockScores equal{
        MatrixXd::Ones(1, blocks),
        std::vector<MatrixXd>(static_cast<std::size_t>(blocks), MatrixXd::Constant(1, 1, 4.0))};
    const MatrixXd S = MatrixXd::Constant(1, 1, 0.25 / blocks);
    const ClusterDegrees degrees = clusterRobust(equal, S).degrees;
    EXPECT_NEAR(degrees.of(VectorXd::Ones(1)), blocks - 1, 1e-9);
    EXPECT_NEAR(degrees.of(VectorXd::Constant(1, -1e-6)), blocks - 1, 1e-9);
  }
}

// The variance of a combination of parameters is a chi-square with the degrees of freedom that are
// stated of it, which no parameter's are.
TEST(ClusterRobust, CombinationsHaveDegreesOfFreedomOfTheirOwn) {
  constexpr int kDraws = 5000;
  const auto X = designs();
  const MatrixXd S = regressionCovariance(X);
  std::mt19937_64 random(4);
  const Eigen::Vector3d combination(1, 500, -2);
  double mean = 0, square = 0, dof = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const ClusterRobust robust = clusterRobust(drawn(X, S, random), S);
    const double v = combination.dot(robust.matrix * combination);
    mean += v / kDraws;
    square += v * v / kDraws;
    if (draw == 0) dof = robust.degrees.of(combination);
  }
  EXPECT_NEAR(mean / combination.dot(S * combination), 1, 0.03);
  EXPECT_NEAR(dof / (2 * mean * mean / (square - mean * mean)), 1, 0.1);
}

TEST(ClusterRobust, AgreesWithTheAdjustmentOfResidualsByRows) {
  const auto X = designs();
  const MatrixXd S = regressionCovariance(X);
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  BlockScores blocks{MatrixXd(kParameters, kBlocks), {}};
  MatrixXd expected = MatrixXd::Zero(kParameters, kParameters);
  for (std::size_t b = 0; b < X.size(); ++b) {
    const VectorXd e = VectorXd::NullaryExpr(kRows, [&] { return normal(random); });
    blocks.scores.col(static_cast<Eigen::Index>(b)) = X[b].transpose() * e;
    blocks.information.emplace_back(X[b].transpose() * X[b]);
    const MatrixXd redundancy = MatrixXd::Identity(kRows, kRows) - X[b] * S * X[b].transpose();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(redundancy);
    const VectorXd u = S * X[b].transpose() * eigen.operatorInverseSqrt() * e;
    expected += u * u.transpose();
  }
  const MatrixXd matrix = clusterRobust(blocks, S).matrix;
  EXPECT_LT((matrix - expected).norm(), 1e-10 * expected.norm());
}

TEST(ClusterRobust, BlocksAreTwoCorrelationLengthsAndSixAtLeast) {
  EXPECT_EQ(blocksOf(100, 1), 100);
  EXPECT_EQ(blocksOf(100, 5), 10);
  EXPECT_EQ(blocksOf(100, 30), 6);
  EXPECT_EQ(blocksOf(4, 3), 4);
  EXPECT_DOUBLE_EQ(shareWithin(3, 1), 1);
  EXPECT_NEAR(shareWithin(10, 5), 1 - (1 - std::exp(-4.0)) / 4, 1e-12);
}

TEST(ClusterRobust, CorrelationLengthOfAMarkovProcess) {
  constexpr int kPieces = 4000;
  constexpr double kCorrelation = 0.6;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  MatrixXd scores(kParameters, kPieces);
  for (int k = 0; k < kParameters; ++k) {
    double x = normal(random);
    for (int i = 0; i < kPieces; ++i) {
      scores(k, i) = x;
      x = kCorrelation * x + std::sqrt(1 - kCorrelation * kCorrelation) * normal(random);
    }
  }
  // (1 + c) / (1 - c), the tail below a correlation of 0.1 left out: lags 1 to 4.
  const double expected = 1 + 2 * (0.6 + 0.36 + 0.216 + 0.1296);
  EXPECT_NEAR(correlationLength(scores, MatrixXd::Identity(kParameters, kParameters)), expected,
              0.3);
}

}  // namespace
}  // namespace plumbline
