// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/information/covariance.h"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/calibrator/information/random_information.h"

namespace plumbline {
namespace {

using test::randomInformation;

TEST(Covariance, IsTheInverseWhateverTheUnits) {
  const Eigen::MatrixXd information = randomInformation(8, 40, 1);
  const auto covariance = covarianceOf(information);
  ASSERT_TRUE(covariance.has_value());
  EXPECT_EQ(*covariance, covariance->transpose());
  const Eigen::VectorXd std = covariance->diagonal().cwiseSqrt();
  const Eigen::MatrixXd product = *covariance * information;
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 8; ++j) {
      // Entry (i, j) of the product is in units of i per unit of j.
      EXPECT_NEAR(product(i, j) * std(j) / std(i), i == j ? 1 : 0, 1e-12);
    }
  }
}

TEST(Covariance, OfARankDeficientMatrixDoesNotExist) {
  EXPECT_FALSE(covarianceOf(randomInformation(8, 7, 1)).has_value());
  EXPECT_FALSE(logDeterminant(Eigen::MatrixXd::Zero(3, 3)).has_value());
  EXPECT_FALSE(entropyNats(-Eigen::MatrixXd::Identity(2, 2)).has_value());
  EXPECT_FALSE(logDeterminant(Eigen::MatrixXd::Constant(2, 2, std::nan(""))).has_value());
}

TEST(Entropy, OfIndependentParametersIsTheSumOfTheirs) {
  const Eigen::Vector3d std(0.5, 20, 1e-3);
  const Eigen::MatrixXd information = std.cwiseAbs2().cwiseInverse().asDiagonal();
  double sum = 0;
  for (const double s : std) {
    sum += 0.5 * std::log(2 * std::numbers::pi * std::numbers::e * s * s);
  }
  EXPECT_NEAR(*entropyNats(information), sum, 1e-12);
}

TEST(Entropy, IsTheSameByInformationAndByCovariance) {
  const Eigen::MatrixXd information = randomInformation(6, 20, 4);
  EXPECT_NEAR(*entropyNatsOfCovariance(*covarianceOf(information)), *entropyNats(information),
              1e-10);
  EXPECT_FALSE(entropyNatsOfCovariance(-Eigen::MatrixXd::Identity(2, 2)).has_value());
}

TEST(Entropy, ChangesWithTheUnitOfAParameterByItsLogarithm) {
  const Eigen::MatrixXd in_metres = randomInformation(4, 20, 2);
  Eigen::MatrixXd in_millimetres = in_metres;
  in_millimetres.row(1) *= 1e-3;
  in_millimetres.col(1) *= 1e-3;
  EXPECT_NEAR(*entropyNats(in_millimetres) - *entropyNats(in_metres), std::log(1e3), 1e-9);
}

TEST(MutualInformation, HalvingTheStandardDeviationOfOneParameterTellsOneBit) {
  const Eigen::MatrixXd before = Eigen::Vector3d(4, 9, 16).asDiagonal();
  const Eigen::MatrixXd after = Eigen::Vector3d(4, 36, 16).asDiagonal();
  EXPECT_NEAR(bitsFromNats(*mutualInformationNats(before, after)), 1, 1e-14);
}

TEST(MutualInformation, IsTheFallOfEntropy) {
  const Eigen::MatrixXd before = randomInformation(6, 30, 3);
  const Eigen::MatrixXd after = before + randomInformation(6, 4, 4);
  EXPECT_NEAR(*mutualInformationNats(before, after), *entropyNats(before) - *entropyNats(after),
              1e-10);
}

TEST(FreeDirections, NameTheParametersThatTradeAgainstEachOther) {
  // Parameters 1 and 3 are seen through their sum alone.
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3, 4);
  J(0, 0) = 10;
  J(1, 1) = J(1, 3) = 10;
  J(2, 2) = 10;
  const auto free = freeDirections(J.transpose() * J, Eigen::VectorXd::Ones(4));
  ASSERT_EQ(free.size(), 1u);
  EXPECT_GT(free[0].std, 1e6);
  EXPECT_THAT(free[0].leading, ::testing::UnorderedElementsAre(1, 3));
  EXPECT_NEAR(free[0].weights(1), -free[0].weights(3), 1e-9);
}

TEST(FreeDirections, AreJudgedByTheSizeOfEachParameter) {
  const Eigen::MatrixXd information = Eigen::Vector2d(1 / 0.01, 1 / 0.01).asDiagonal();  // std 0.1
  EXPECT_TRUE(freeDirections(information, Eigen::Vector2d(1, 1)).empty());
  const auto free = freeDirections(information, Eigen::Vector2d(1, 0.05));
  ASSERT_EQ(free.size(), 1u);
  EXPECT_THAT(free[0].leading, ::testing::ElementsAre(1));
  EXPECT_NEAR(free[0].std, 2, 1e-12);  // 0.1 in units of 0.05
}

}  // namespace
}  // namespace plumbline
