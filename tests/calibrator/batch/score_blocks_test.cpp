// SPDX-License-Identifier: BSD-3-Clause
// Blocks of time that make robust deviations of the camera-IMU batch. Not proven here: that the
// deviations are right (robust_deviations_statistics_test.cpp).
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/batch/faults/score_tests.h"

namespace plumbline {
namespace {

constexpr int kBorderColumns = BorderLayout::kFixed;

/// Scores that neighbours share in part, as those of corners that err together do.
std::vector<ScoreBlock> correlatedBlocks(int count) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  std::vector<ScoreBlock> out;
  Eigen::VectorXd noise = Eigen::VectorXd::Zero(kBorderColumns);
  for (int b = 0; b < count; ++b) {
    noise =
        0.8 * noise + Eigen::VectorXd::NullaryExpr(kBorderColumns, [&] { return normal(random); });
    out.push_back(
        {b, 10, noise, (1 + b % 3) * Eigen::MatrixXd::Identity(kBorderColumns, kBorderColumns)});
  }
  return out;
}

/// Nothing was recorded for so many blocks, in the middle.
std::vector<ScoreBlock> withPause(std::vector<ScoreBlock> blocks, int pause) {
  const ScoreBlock unseen{0, 0, Eigen::VectorXd::Zero(kBorderColumns),
                          Eigen::MatrixXd::Zero(kBorderColumns, kBorderColumns)};
  const auto middle = static_cast<std::ptrdiff_t>(blocks.size() / 2);
  blocks.insert(blocks.begin() + middle, static_cast<std::size_t>(pause), unseen);
  return blocks;
}

RobustDeviations deviationsOf(const std::vector<ScoreBlock>& blocks) {
  Terms model;
  for (int column = 0; column < kBorderColumns; ++column) model.push_back({column, 0});
  const Scores scores(blocks);
  return ScoreTests(scores, model)
      .clusterRobustDeviations(Eigen::MatrixXd::Identity(kBorderColumns, kBorderColumns));
}

TEST(ScoreBlocks, APauseChangesNoDeviation) {
  for (const int count : {12, 40}) {
    const std::vector<ScoreBlock> blocks = correlatedBlocks(count);
    const RobustDeviations without = deviationsOf(blocks);
    const RobustDeviations with = deviationsOf(withPause(blocks, count));
    EXPECT_TRUE(with.std.isApprox(without.std, 1e-9)) << count;
    EXPECT_TRUE(with.dof.isApprox(without.dof, 1e-9)) << count;
  }
}

constexpr double kRange = 0.25;

/// Scores beside which a fault of three components stands, of which the motion determines all but
/// the direction `weak`; with noise as it is assumed.
std::vector<ScoreBlock> blocksWithFault(const Eigen::Vector3d& fault, const Eigen::Vector3d& weak) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  const Eigen::Matrix3d along = weak * weak.transpose();
  std::vector<ScoreBlock> out;
  for (int b = 0; b < 40; ++b) {
    constexpr int kAll = kBorderColumns + 3;
    Eigen::MatrixXd information = Eigen::MatrixXd::Identity(kAll, kAll);
    information.bottomRightCorner<3, 3>() =
        100 * (Eigen::Matrix3d::Identity() - along) + 0.01 * along;
    Eigen::VectorXd gradient =
        information.llt().matrixL() *
        Eigen::VectorXd(Eigen::VectorXd::NullaryExpr(kAll, [&] { return normal(random); }));
    // What second order leaves where nothing is determined: an estimate of three.
    gradient.tail<3>() -= information.bottomRightCorner<3, 3>() * (fault + 3 * weak);
    out.push_back({b, 10, gradient, information});
  }
  return out;
}

FaultTest testOf(const Scores& scores, double range) {
  Terms model, fault;
  for (int column = 0; column < kBorderColumns; ++column) model.push_back({column, 0});
  for (int k = 0; k < 3; ++k) fault.push_back({kBorderColumns + k, 0});
  return ScoreTests(scores, model).test(fault, range);
}

// A rig that does not turn about z says nothing of a gyroscope's z, and all of its x.
TEST(ScoreTests, AComponentThatTheMotionDoesNotDetermineHidesNoOther) {
  const Scores scores(blocksWithFault({0.2, 0, 0}, {0, 0, 1}));
  const FaultTest whole = testOf(scores, 10);
  EXPECT_EQ(whole.dof, 3);
  EXPECT_GT(std::abs(whole.estimate(2)), kRange) << "which is no test";
  const FaultTest part = testOf(scores, kRange);
  EXPECT_EQ(part.dof, 2);
  EXPECT_LT(part.estimate.cwiseAbs().maxCoeff(), kRange);
  EXPECT_NEAR(part.estimate(0), 0.2, 4 * part.std(0));
  EXPECT_NEAR(part.estimate(1), 0, 4 * part.std(1));
  EXPECT_LT(part.std(0), 0.03);
  EXPECT_EQ(part.estimate(2), 0);
  EXPECT_TRUE(std::isnan(part.std(2)));
  EXPECT_GT(part.significance, 5);
}

TEST(ScoreTests, NoComponentOfAnUndeterminedCombinationIsToldByItself) {
  const double half = std::sqrt(0.5);
  const FaultTest part = testOf(Scores(blocksWithFault({0.2, 0, 0}, {0, half, -half})), kRange);
  EXPECT_EQ(part.dof, 2);
  EXPECT_NEAR(part.estimate(0), 0.2, 4 * part.std(0));
  EXPECT_TRUE(std::isnan(part.std(1)) && std::isnan(part.std(2)));
  EXPECT_NEAR(part.estimate(1), part.estimate(2), 1e-6);
}

// Beyond the range though it is determined: no part of it is named in its place.
TEST(ScoreTests, OfALargeFaultThatIsDeterminedNothingIsHeld) {
  const Scores scores(blocksWithFault({0.2, 0, 0}, Eigen::Vector3d::Zero()));
  EXPECT_EQ(testOf(scores, 0.15).dof, 3);
  EXPECT_EQ(testOf(scores, kRange).std.hasNaN(), false);
}

}  // namespace
}  // namespace plumbline
