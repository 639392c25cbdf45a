// SPDX-License-Identifier: BSD-3-Clause
// The camera-IMU stage on simulated recordings: its end, its decisions, and what it does with bad
// input. The trajectories' scores and the window have tests of their own.
#include "calibrator/guidance/camera_imu_guide.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/calibrator/guidance/imu_guide_replay.h"

namespace plumbline {
namespace {

constexpr double kSigma = 0.2;  // [px]

SimulatedSession simulated(double duration_s) {
  SimulationOptions options;
  options.duration_s = duration_s;
  options.corner_sigma_px = kSigma;
  options.seed = options.trajectory.seed = 1;
  return simulateSession(simulatedRig("euroc"), options);
}

/// Shared by the tests, for simulation takes longer than the guide.
const SimulatedSession& recording() {
  static const SimulatedSession s = simulated(8);
  return s;
}

/// Squared error and the noise that was simulated; a threshold that 8 s of recording reach.
GuideOptions matched() {
  GuideOptions options;
  options.trajectories.pixel_sigma = kSigma;
  options.trajectories.cauchy_px = 0;
  options.trajectories.threshold_nats = 1.2;
  return options;
}

CameraImuGuide guideFor(const SimulatedSession& s, const GuideOptions& options) {
  return {testing::rigOf(s), s.truth.cameras, options};
}

TEST(CameraImuGuide, FinishesWithAnExtrinsicCalibrationWithinItsCovariance) {
  CameraImuGuide guide = guideFor(recording(), matched());
  const auto decisions = testing::replay(guide, testing::framesOf(recording().session));
  ASSERT_TRUE(guide.finished());
  const auto result = guide.batch();
  ASSERT_TRUE(result) << result.failure().message;
  const Vector6d error = boxminus(recording().truth.imu->T_SC0, result->imu.T_SC0);
  const Eigen::MatrixXd covariance = result->summary.covariance.matrix.topLeftCorner(6, 6);
  EXPECT_LT(error.dot(covariance.llt().solve(error)), 22.46);  // chi-square, 6 dof, 99.9 %
}

}  // namespace
}  // namespace plumbline
