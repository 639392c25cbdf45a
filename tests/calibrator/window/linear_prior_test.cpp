// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/window/linear_prior.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

TEST(LinearPrior, KnowsAHandValue) {
  QuadraticCost cost{Eigen::MatrixXd(2, 2), Eigen::Vector2d(1, -2), 3};
  cost.H << 4, 1, 1, 2;
  const QuadraticCost at = LinearPrior(cost).at(Eigen::Vector2d(2, -1));
  EXPECT_EQ(at.c, 3 + 4 + 0.5 * (16 - 4 + 2));  // c + b.d + 0.5 d.H d
  EXPECT_EQ(at.b, Eigen::Vector2d(1 + 7, -2 + 0));
  EXPECT_EQ(at.H, cost.H);
}

TEST(LinearPrior, IsTheSameQuadraticWhereverItIsTaken) {
  QuadraticCost cost{Eigen::MatrixXd(2, 2), Eigen::Vector2d(1, -2), 3};
  cost.H << 4, 1, 1, 2;
  const LinearPrior prior(cost);
  const Eigen::Vector2d a(0.5, 2);
  const Eigen::Vector2d b(-1, 0.25);
  const QuadraticCost there = LinearPrior(prior.at(a)).at(b);
  const QuadraticCost direct = prior.at(a + b);
  EXPECT_NEAR(there.c, direct.c, 1e-14);
  EXPECT_LT((there.b - direct.b).norm(), 1e-14);
}

TEST(LinearPrior, KnowsNothingAtFirst) {
  const LinearPrior prior(3);
  EXPECT_EQ(prior.size(), 3);
  const QuadraticCost at = prior.at(Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(at.c, 0);
  EXPECT_EQ(at.b, Eigen::Vector3d::Zero());
  EXPECT_EQ(at.H, Eigen::Matrix3d::Zero());
}

}  // namespace
}  // namespace plumbline
