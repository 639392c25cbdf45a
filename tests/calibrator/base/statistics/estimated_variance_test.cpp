// SPDX-License-Identifier: BSD-3-Clause
// Intervals from deviations that are estimates themselves.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "calibrator/base/statistics/statistics.h"

namespace plumbline {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Tables of Student's t, one-sided 95 %.
TEST(HalfWidth90, IsTheDeviationTimesStudentsQuantile) {
  EXPECT_NEAR(halfWidth90(1, 1), 6.3138, 1e-4);
  EXPECT_NEAR(halfWidth90(1, 2), 2.9200, 1e-4);
  EXPECT_NEAR(halfWidth90(1, 5), 2.0150, 1e-4);
  EXPECT_NEAR(halfWidth90(0.1, 10), 0.18125, 1e-5);
  EXPECT_NEAR(halfWidth90(2, 30), 2 * 1.6973, 2e-4);
  EXPECT_NEAR(halfWidth90(3, kInfinity), 3 * 1.644854, 1e-5);
  EXPECT_EQ(halfWidth90(0, 5), 0);
}

TEST(HalfWidth90, IsNotKnownWhereTheDeviationOrItsDegreesOfFreedomAreNot) {
  EXPECT_TRUE(std::isnan(halfWidth90(kNaN, 5)));
  EXPECT_TRUE(std::isnan(halfWidth90(1, kNaN)));
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  EXPECT_FALSE(halfWidths90(one, std::nullopt));
  EXPECT_FALSE(halfWidths90(std::nullopt, one));
  const auto both = halfWidths90(one, one);
  ASSERT_TRUE(both);
  EXPECT_NEAR((*both)(0), 6.3138, 1e-4);
}

TEST(EstimatedVariance, SumsHaveWelchsAndSatterthwaitesDegreesOfFreedom) {
  // (1 + 2)^2 / (1 / 5 + 4 / 10) = 15
  const EstimatedVariance both = sumOf({1, 5}, {2, 10});
  EXPECT_DOUBLE_EQ(both.value, 3);
  EXPECT_DOUBLE_EQ(both.dof, 15);
  EXPECT_DOUBLE_EQ(sumOf({4, 6}, {4, 6}).dof, 12);          // alike: those of both
  EXPECT_DOUBLE_EQ(sumOf({1, 6}, {0, 3}).dof, 6);           // nothing is added
  EXPECT_DOUBLE_EQ(sumOf({1, 6}, {1, kInfinity}).dof, 24);  // what is known adds no doubt
  EXPECT_EQ(sumOf({1, kInfinity}, {1, kInfinity}).dof, kInfinity);
  EXPECT_EQ(sumOf({0, 5}, {0, 5}).value, 0);
  EXPECT_EQ(sumOf({0, 5}, {0, 5}).dof, kInfinity);
}

// Two blocks of one parameter each say half: (I - G)^(-1/2) = sqrt(2), W = [0.5 -0.5; -0.5 0.5].
TEST(RobustCovariance, WhatIsKnownOfAVarianceRaisesItsDegreesOfFreedom) {
  RobustCovariance robust;
  robust.matrix = Eigen::MatrixXd::Constant(1, 1, 4);
  const Eigen::MatrixXd half = Eigen::MatrixXd::Constant(1, 1, 0.5);
  const Eigen::MatrixXd root2 = Eigen::MatrixXd::Constant(1, 1, std::sqrt(2));
  robust.degrees = {{root2, root2}, {half, half}};
  const Eigen::VectorXd twice = Eigen::VectorXd::Constant(1, 2);
  EXPECT_DOUBLE_EQ(robust.variance(twice).value, 16);
  EXPECT_NEAR(robust.variance(twice).dof, 1, 1e-12);
  robust.known = Eigen::MatrixXd::Constant(1, 1, 3);
  EXPECT_DOUBLE_EQ(robust.variance(twice).value, 16);
  EXPECT_NEAR(robust.variance(twice).dof, 16, 1e-12);  // (1 + 3)^2 / (1 / 1)
  const RobustDeviations deviations = robust.deviations(1);
  EXPECT_DOUBLE_EQ(deviations.std(0), 2);
  EXPECT_NEAR(deviations.dof(0), 16, 1e-12);
}

TEST(RobustCovariance, WithoutTheCommonErrorHasWhatElseIsKnown) {
  RobustCovariance robust;
  robust.matrix = Eigen::MatrixXd::Constant(1, 1, 4);
  EXPECT_EQ(robust.withoutCommon().matrix, robust.matrix);
  robust.known = Eigen::MatrixXd::Constant(1, 1, 3);
  robust.common = Eigen::MatrixXd::Constant(1, 1, 2);
  const RobustCovariance rest = robust.withoutCommon();
  EXPECT_EQ(rest.matrix(0, 0), 2);
  EXPECT_EQ(rest.known(0, 0), 1);
  EXPECT_EQ(rest.common.size(), 0);
}

}  // namespace
}  // namespace plumbline
