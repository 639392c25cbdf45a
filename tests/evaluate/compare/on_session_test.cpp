// SPDX-License-Identifier: BSD-3-Clause
// Which of two calibrations predicts the corners of the same views better, and what a comparison
// estimates on the session itself.
#include "evaluate/compare/on_session.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/simulate/simulate_session.h"
#include "tests/evaluate/compare/compared_rigs.h"

namespace plumbline {
namespace {

CameraStageResult errorsOf(const std::vector<float>& per_view) {
  CameraStageResult result;
  result.cameras = test::stereo().cameras;
  for (std::size_t f = 0; f < per_view.size(); ++f) {
    result.frames.push_back({static_cast<TimeNs>(f), {static_cast<int>(f), -1}});
    for (int id = 0; id < 2; ++id) {
      CornerResidual r;
      r.frame = static_cast<int>(f);
      r.corner_id = id;
      r.error = Eigen::Vector2f(per_view[f], 0);
      result.residuals.push_back(r);
    }
  }
  return result;
}

// 50 views, of whose squared errors those of a block of ten are alike: 4, 0, 3, -1 and 9 more.
TEST(PairedPrediction, MeanAndIntervalAreOfBlocksOfViews) {
  std::vector<float> first, other;
  for (const float difference : {4, 0, 3, -1, 9}) {
    first.insert(first.end(), 10, 2);
    other.insert(other.end(), 10, std::sqrt(4 + difference));
  }
  const auto paired = pairedPredictions(errorsOf(first), errorsOf(other), "b");
  ASSERT_EQ(paired.size(), 1u);  // the second camera saw nothing
  EXPECT_EQ(paired[0].views, 50);
  EXPECT_EQ(paired[0].blocks, 5);
  EXPECT_NEAR(paired[0].difference_px2, 3, 1e-6);
  EXPECT_NEAR(paired[0].first_px2, 4, 1e-9);
  // Squares of the deviations from 3: 1, 9, 0, 16, 36.
  EXPECT_NEAR(paired[0].std_px2, std::sqrt(62.0 / 4 / 5), 1e-6);
  EXPECT_NEAR(paired[0].half_px2, 2.776445 * std::sqrt(62.0 / 4 / 5), 1e-5);
  EXPECT_FALSE(paired[0].isClear());  // it would be by the normal distribution's 1.96
}

// Streams need not begin together: a view is known by its own place in its camera's stream.
TEST(PairedPrediction, ViewsOfTheSecondCameraArePairedByTheirOwnIndex) {
  CameraStageResult first = errorsOf({1, 2, 3}), other = errorsOf({2, 2, 2});
  for (CameraStageResult* result : {&first, &other}) {
    for (CornerResidual& r : result->residuals) r.camera = 1;
  }
  // `other` lacks the frame that `first` begins with, and camera 0's views count otherwise.
  for (int f = 0; f < 3; ++f) {
    first.frames[static_cast<std::size_t>(f)].view = {7 - f, f};
    other.frames[static_cast<std::size_t>(f)].view = {7 - f, f + 1};
  }
  const auto paired = pairedPredictions(first, other, "b");
  ASSERT_EQ(paired.size(), 1U);
  EXPECT_EQ(paired[0].camera, "cam1");
  EXPECT_EQ(paired[0].views, 2);
  EXPECT_NEAR(paired[0].first_px2, (4.0 + 9) / 2, 1e-9);
}

TEST(PairedPrediction, OfFewBlocksThereIsNoInterval) {
  const auto paired = pairedPredictions(errorsOf({1, 2, 3}), errorsOf({2, 2, 2}), "b");
  ASSERT_EQ(paired.size(), 1u);
  EXPECT_EQ(paired[0].views, 3);
  // Squares 4-1, 4-4, 4-9.
  EXPECT_NEAR(paired[0].difference_px2, -2.0 / 3, 1e-9);
  EXPECT_NEAR(paired[0].first_px2, (1.0 + 4 + 9) / 3, 1e-9);
  EXPECT_EQ(paired[0].std_px2, 0);
  EXPECT_FALSE(paired[0].isClear());
}

TEST(PairedPrediction, OnlyViewsUnderBothCount) {
  CameraStageResult other = errorsOf({1, 1, 1});
  for (CornerResidual& r : other.residuals) r.used = r.frame != 0;
  const auto paired = pairedPredictions(errorsOf({9, 1, 1}), other, "b");
  ASSERT_EQ(paired.size(), 1u);
  EXPECT_EQ(paired[0].views, 2);
  EXPECT_EQ(paired[0].difference_px2, 0);
}

TEST(OwnEstimateOfTheSession, AStageThatDidNotConvergeIsNoWitness) {
  SimulationOptions simulation;
  simulation.duration_s = 6;
  simulation.camera_rate_hz = 5;
  const SimulatedSession simulated = simulateSession(simulatedRig("euroc"), simulation);
  ScoreOptions options;
  options.camera_imu.max_iterations = 1;
  const SessionEstimate own = sessionEstimate(
      simulated.session, std::vector<Calibration>{simulated.truth}, options, TargetMode::kGiven);
  EXPECT_NE(own.problem.find("did not converge"), std::string::npos) << own.problem;
  EXPECT_EQ(own.calibration.cameras.size(), 2U);
  EXPECT_FALSE(own.calibration.imu);
}

}  // namespace
}  // namespace plumbline
