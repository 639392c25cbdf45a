// SPDX-License-Identifier: BSD-3-Clause
// The bootstrap of the camera-IMU calibration on a recording whose noise is what the covariance
// assumes: then both must tell the same.
#include <gtest/gtest.h>

#include "calibrator/batch/camera_imu/batch.h"
#include "tests/calibrator/batch/camera_imu_examples.h"

namespace plumbline {
namespace {

struct Solved {
  SimulatedSession simulated;
  CameraImuOptions options;
  CameraImuStageResult result;
};

Solved solved(std::uint64_t seed) {
  SimulationOptions simulation = test::noisyRecording(seed, 15);
  simulation.camera_rate_hz = 10;
  SimulatedSession s = test::simulate(simulation);
  CameraImuOptions options = test::matchedOptions(s, 0.2);
  options.diagnose_faults = false;
  auto result = calibrateCameraImu(s.session, s.truth.cameras, options);
  if (!result) throw std::runtime_error(toString(result.failure()));
  return {std::move(s), options, std::move(result).value()};
}

TEST(CameraImuResample, SpreadIsThatOfTheCovarianceWhereTheModelHolds) {
  const Solved s = solved(1);
  ResampleOptions resample;
  resample.draws = 20;
  resample.segments = 8;
  const auto summary = resampleCameraImu(s.simulated.session, s.result, resample, s.options);
  ASSERT_TRUE(summary) << summary.failure();
  EXPECT_EQ(summary->failed, 0);
  EXPECT_EQ(summary->names, s.result.summary.covariance.names);
  const Eigen::VectorXd ratio =
      summary->std.cwiseQuotient(s.result.summary.covariance.standardDeviations());
  // Few unlike segments, and their cuts lose the continuity of the biases: the spread is of the
  // covariance's size, not equal to it.
  const double typical = std::exp(ratio.array().log().mean());
  EXPECT_GT(typical, 0.6);
  EXPECT_LT(typical, 1.8);
  EXPECT_LT(ratio.maxCoeff(), 3);
}

TEST(CameraImuResample, DoesNotDependOnTheNumberOfThreads) {
  const Solved s = solved(2);
  ResampleOptions resample;
  resample.draws = 4;
  resample.segments = 5;
  const auto one = resampleCameraImu(s.simulated.session, s.result, resample, s.options);
  resample.threads = 3;
  const auto three = resampleCameraImu(s.simulated.session, s.result, resample, s.options);
  ASSERT_TRUE(one && three);
  EXPECT_EQ(one->draws, three->draws);
}

}  // namespace
}  // namespace plumbline
