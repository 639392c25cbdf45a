// SPDX-License-Identifier: BSD-3-Clause
// The Schur complement against the full inverse with rows dropped, which shares nothing with it.
#include <Eigen/LU>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "calibrator/linear/dense.h"

namespace plumbline {
namespace {

/// Information of 3 n random measurements of n parameters whose units differ by up to 1e6.
QuadraticCost randomCost(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd J(3 * n, n);
  for (int i = 0; i < J.rows(); ++i) {
    for (int j = 0; j < n; ++j) J(i, j) = normal(random) * std::pow(10, 6.0 * j / n - 3);
  }
  Eigen::VectorXd e(3 * n);
  for (int i = 0; i < e.size(); ++i) e(i) = normal(random);
  return {J.transpose() * J, J.transpose() * e, 0.5 * e.squaredNorm()};
}

double valueAt(const QuadraticCost& cost, const Eigen::VectorXd& d) {
  return cost.c + cost.b.dot(d) + 0.5 * d.dot(cost.H * d);
}

const std::vector<int> kKeep = {7, 0, 3, 4};  // neither sorted nor together

TEST(Schur, CovarianceIsTheFullInverseWithRowsDropped) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const QuadraticCost cost = randomCost(9, seed);
    const auto kept = marginalised(cost, kKeep);
    ASSERT_TRUE(kept.has_value());
    const Eigen::MatrixXd full = cost.H.inverse();
    const Eigen::MatrixXd expected = full(kKeep, kKeep);
    const Eigen::MatrixXd covariance = kept->H.inverse();
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        const double scale = std::sqrt(expected(i, i) * expected(j, j));
        EXPECT_NEAR(covariance(i, j), expected(i, j), 1e-9 * scale) << seed;
      }
    }
    EXPECT_EQ(kept->H, kept->H.transpose());
  }
}

// The estimate -H^-1 b has the covariance H^-1 V H^-1 by noise of variance V in b, whether the
// other parameters were eliminated before or not.
TEST(Schur, NoiseOfTheGradientIsCarriedAlong) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    QuadraticCost cost = randomCost(9, seed);
    cost.noise = randomCost(9, seed + 100).H;
    const auto kept = marginalised(cost, kKeep);
    ASSERT_TRUE(kept.has_value());
    const Eigen::MatrixXd full = cost.H.inverse() * cost.noise * cost.H.inverse();
    const Eigen::MatrixXd expected = full(kKeep, kKeep);
    const Eigen::MatrixXd covariance = kept->H.inverse() * kept->noise * kept->H.inverse();
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        const double scale = std::sqrt(expected(i, i) * expected(j, j));
        EXPECT_NEAR(covariance(i, j), expected(i, j), 1e-8 * scale) << seed;
      }
    }
  }
  EXPECT_EQ(marginalised(randomCost(9, 1), kKeep)->noise.size(), 0) << "where none is followed";
}

TEST(Schur, MinimumOfTheParametersKeptStaysWhereItWasAndAsDeep) {
  const QuadraticCost cost = randomCost(9, 3);
  const auto kept = marginalised(cost, kKeep);
  ASSERT_TRUE(kept.has_value());
  const Eigen::VectorXd minimum = -cost.H.fullPivLu().solve(cost.b);
  const Eigen::VectorXd kept_minimum = -kept->H.fullPivLu().solve(kept->b);
  for (int i = 0; i < 4; ++i) {
    const double expected = minimum(kKeep[static_cast<std::size_t>(i)]);
    EXPECT_NEAR(kept_minimum(i), expected, 1e-9 * std::abs(expected));
  }
  EXPECT_NEAR(valueAt(*kept, kept_minimum), valueAt(cost, minimum), 1e-9 * cost.c);
}

TEST(Schur, CostIsThatOfTheBestParametersDropped) {
  const QuadraticCost cost = randomCost(6, 4);
  const std::vector<int> keep = {1, 4};
  const std::vector<int> drop = {0, 2, 3, 5};
  const auto kept = marginalised(cost, keep);
  ASSERT_TRUE(kept.has_value());
  const Eigen::VectorXd d_keep = 1e-2 * Eigen::Vector2d(3, -2);
  Eigen::VectorXd d = Eigen::VectorXd::Zero(6);
  d(keep) = d_keep;
  const Eigen::VectorXd gradient = cost.b + cost.H * d;
  const Eigen::MatrixXd H_dd = cost.H(drop, drop);
  d(drop) -= H_dd.fullPivLu().solve(gradient(drop));
  EXPECT_NEAR(valueAt(*kept, d_keep), valueAt(cost, d), 1e-10 * std::abs(valueAt(cost, d)));
  // Any other choice costs more.
  Eigen::VectorXd other = d;
  other(2) += 1 / std::sqrt(cost.H(2, 2));
  EXPECT_GT(valueAt(cost, other), valueAt(*kept, d_keep) + 0.1);
}

TEST(Schur, KnowsAHandValue) {
  QuadraticCost cost{Eigen::MatrixXd(2, 2), Eigen::VectorXd(2), 5};
  cost.H << 4, 2, 2, 3;
  cost.b << 6, 4;
  const auto kept = marginalised(cost, {1});
  ASSERT_TRUE(kept.has_value());
  EXPECT_NEAR(kept->H(0, 0), 2, 1e-15);  // 3 - 2 * 2 / 4
  EXPECT_NEAR(kept->b(0), 1, 1e-15);     // 4 - 2 * 6 / 4
  EXPECT_NEAR(kept->c, 0.5, 1e-15);      // 5 - 6 * 6 / (2 * 4)
}

TEST(Schur, KeepingAllOnlyOrders) {
  const QuadraticCost cost = randomCost(3, 5);
  const auto kept = marginalised(cost, {2, 0, 1});
  ASSERT_TRUE(kept.has_value());
  EXPECT_EQ(kept->H(0, 1), cost.H(2, 0));
  EXPECT_EQ(kept->b(2), cost.b(1));
  EXPECT_EQ(kept->c, cost.c);
}

TEST(Schur, UndeterminedParametersCannotBeDropped) {
  QuadraticCost cost = randomCost(5, 6);
  cost.H.row(3) = cost.H.row(2);  // parameters 2 and 3 tell the same
  cost.H.col(3) = cost.H.col(2);
  cost.H(3, 3) = cost.H(2, 2);
  EXPECT_FALSE(marginalised(cost, {0, 1}).has_value());
  EXPECT_TRUE(marginalised(cost, {0, 2}).has_value());  // with 2 kept, 3 is determined
  cost = randomCost(5, 6);
  cost.H.row(4).setZero();
  cost.H.col(4).setZero();
  EXPECT_FALSE(marginalised(cost, {0, 1, 2, 3}).has_value());
  EXPECT_TRUE(marginalised(cost, {0, 1, 4}).has_value());
}

TEST(QuadraticCost, KnowsAHandValue) {
  QuadraticCost cost{Eigen::MatrixXd(2, 2), Eigen::Vector2d(1, -2), 3};
  cost.H << 4, 1, 1, 2;
  const QuadraticCost at = cost.at(Eigen::Vector2d(2, -1));
  EXPECT_EQ(at.c, 3 + 4 + 0.5 * (16 - 4 + 2));  // c + b.d + 0.5 d.H d
  EXPECT_EQ(at.b, Eigen::Vector2d(1 + 7, -2 + 0));
  EXPECT_EQ(at.H, cost.H);
}

TEST(QuadraticCost, IsTheSameWhereverItIsTaken) {
  QuadraticCost cost{Eigen::MatrixXd(2, 2), Eigen::Vector2d(1, -2), 3};
  cost.H << 4, 1, 1, 2;
  const Eigen::Vector2d a(0.5, 2);
  const Eigen::Vector2d b(-1, 0.25);
  const QuadraticCost there = cost.at(a).at(b);
  const QuadraticCost direct = cost.at(a + b);
  EXPECT_NEAR(there.c, direct.c, 1e-14);
  EXPECT_LT((there.b - direct.b).norm(), 1e-14);
}

TEST(QuadraticCost, ThroughOtherCoordinatesKeepsItsValue) {
  const QuadraticCost cost = randomCost(4, 3);
  const Eigen::MatrixXd J = randomCost(4, 8).H.topRows(4).leftCols(3);
  const Eigen::Vector3d x(0.3, -1, 0.5);
  const double value = cost.at(J * x).c;
  EXPECT_NEAR(cost.through(J).at(x).c, value, 1e-12 * std::abs(value));
}

}  // namespace
}  // namespace plumbline
