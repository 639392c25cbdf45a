// SPDX-License-Identifier: BSD-3-Clause
// Is the covariance of the camera-IMU batch honest? Seeds 1 to 100, the noise that was simulated,
// no tuned factor; a run that fails counts as a failure of the test.
#include <Eigen/Cholesky>

#include <gtest/gtest.h>

#include "tests/calibrator/batch/camera_imu_examples.h"

namespace plumbline {
namespace {

constexpr int kRuns = 100;

// Quantiles 0.0005 and 0.9995 of chi-square with 100 and 300 degrees of freedom.
struct Bounds {
  double low, high;
};
constexpr Bounds kChi2_100{59.8957, 153.1670};
constexpr Bounds kChi2_300{225.8864, 387.2035};

double squaredNorm(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
  return error.dot(covariance.llt().solve(error));
}

class CameraImuStatistics : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Rigs, CameraImuStatistics, ::testing::Values("euroc", "d435i"));

TEST_P(CameraImuStatistics, NormalisedErrorsOfEachBlockAreWithinTheirBounds) {
  double translation = 0;
  double rotation = 0;
  double offset = 0;
  for (int seed = 1; seed <= kRuns; ++seed) {
    SimulationOptions simulation = testing::noisyRecording(static_cast<std::uint64_t>(seed), 6);
    simulation.trajectory.seed = static_cast<std::uint64_t>(seed);
    const SimulatedSession s = testing::simulate(simulation, GetParam());
    const auto result = calibrateCameraImu(s.session, s.truth.cameras,
                                           testing::matchedOptions(s, simulation.corner_sigma_px));
    ASSERT_TRUE(result) << "seed " << seed << ": " << result.failure().message;
    ASSERT_TRUE(result->summary.converged) << "seed " << seed;
    const Eigen::VectorXd error = testing::calibrationError(s, *result);
    const Eigen::MatrixXd& covariance = result->summary.covariance.matrix;
    translation += squaredNorm(error.head(3), covariance.topLeftCorner(3, 3));
    rotation += squaredNorm(error.segment(3, 3), covariance.block(3, 3, 3, 3));
    offset += squaredNorm(error.tail(1), covariance.bottomRightCorner(1, 1));
  }
  RecordProperty("translation", std::to_string(translation));
  RecordProperty("rotation", std::to_string(rotation));
  RecordProperty("offset", std::to_string(offset));
  EXPECT_GT(translation, kChi2_300.low);
  EXPECT_LT(translation, kChi2_300.high);
  EXPECT_GT(rotation, kChi2_300.low);
  EXPECT_LT(rotation, kChi2_300.high);
  EXPECT_GT(offset, kChi2_100.low);
  EXPECT_LT(offset, kChi2_100.high);
}

}  // namespace
}  // namespace plumbline
