// SPDX-License-Identifier: BSD-3-Clause
// Is the covariance of the camera-IMU batch honest? Seeds 1 to 100, the noise that was simulated,
// no tuned factor; a run that fails counts as a failure of the test. Blocks: translation and
// rotation of T_SC0, the offset, and the whole state (15) of the middle frame.
#include <Eigen/Cholesky>

#include <gtest/gtest.h>

#include "calibrator/residuals/imu_residual.h"
#include "tests/calibrator/batch/camera_imu_examples.h"

namespace plumbline {
namespace {

constexpr int kRuns = 100;

// Quantiles 0.0005 and 0.9995 of chi-square with 100, 300 and 1500 degrees of freedom.
struct Bounds {
  double low, high;
};
constexpr Bounds kChi2_100{59.8957, 153.1670};
constexpr Bounds kChi2_300{225.8864, 387.2035};
constexpr Bounds kChi2_1500{1326.2952, 1686.8055};

double squaredNorm(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
  return error.dot(covariance.llt().solve(error));
}

/// Normalised error squared of the middle frame's whole state.
double stateSquaredNorm(const SimulatedSession& simulated, const CameraImuStageResult& result) {
  const std::size_t middle = result.states.size() / 2;
  const ImuState truth = simulated.stateAt(result.frames[middle].t);
  return squaredNorm(boxminus(truth, result.states[middle]),
                     result.state_covariances.value().states[middle]);
}

class CameraImuStatistics : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Rigs, CameraImuStatistics, ::testing::Values("euroc", "tumvi", "d435i"));

TEST_P(CameraImuStatistics, NormalisedErrorsOfEachBlockAreWithinTheirBounds) {
  double translation = 0;
  double rotation = 0;
  double offset = 0;
  double state = 0;
  for (int seed = 1; seed <= kRuns; ++seed) {
    SimulationOptions simulation = test::noisyRecording(static_cast<std::uint64_t>(seed), 6);
    simulation.trajectory.seed = static_cast<std::uint64_t>(seed);
    simulation.camera_rate_hz = 5;  // a quarter of the frames: the claim is of runs
    const SimulatedSession s = test::simulate(simulation, GetParam());
    CameraImuOptions options = test::matchedOptions(s, simulation.corner_sigma_px);
    options.state_covariances = true;
    options.diagnose_faults = false;
    const auto result = calibrateCameraImu(s.session, s.truth.cameras, options);
    ASSERT_TRUE(result) << "seed " << seed << ": " << result.failure();
    ASSERT_TRUE(result->summary.converged) << "seed " << seed;
    const Eigen::VectorXd error = test::calibrationError(s, *result);
    const Eigen::MatrixXd& covariance = result->summary.covariance.matrix;
    translation += squaredNorm(error.head(3), covariance.topLeftCorner(3, 3));
    rotation += squaredNorm(error.segment(3, 3), covariance.block(3, 3, 3, 3));
    offset += squaredNorm(error.tail(1), covariance.bottomRightCorner(1, 1));
    state += stateSquaredNorm(s, *result);
  }
  RecordProperty("translation", std::to_string(translation));
  RecordProperty("rotation", std::to_string(rotation));
  RecordProperty("offset", std::to_string(offset));
  RecordProperty("state", std::to_string(state));
  EXPECT_GT(translation, kChi2_300.low);
  EXPECT_LT(translation, kChi2_300.high);
  EXPECT_GT(rotation, kChi2_300.low);
  EXPECT_LT(rotation, kChi2_300.high);
  EXPECT_GT(offset, kChi2_100.low);
  EXPECT_LT(offset, kChi2_100.high);
  EXPECT_GT(state, kChi2_1500.low);
  EXPECT_LT(state, kChi2_1500.high);
}

}  // namespace
}  // namespace plumbline
