// SPDX-License-Identifier: BSD-3-Clause
// Blocks of time that make robust deviations of the camera-IMU batch. Not proven here: that the
// deviations are right (robust_deviations_statistics_test.cpp).
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/batch/camera_imu/score_tests.h"

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

}  // namespace
}  // namespace plumbline
