// SPDX-License-Identifier: BSD-3-Clause
// Is the windowed estimate of T_SC0 consistent? Recordings of 8 s with seeds 1 to 100, the noise
// that was simulated, the time offset at its true value (a window holds it); a run that fails
// counts as a failure of the test.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/calibrator/window/imu_window_recording.h"

namespace plumbline {
namespace {

constexpr int kRuns = 100;
// Quantiles 0.025 and 0.975 of chi-square with 600 degrees of freedom, over 100 runs.
constexpr double kLowest = 5.3402;
constexpr double kHighest = 6.6977;

TEST(CameraImuWindowStatistics, MeanNormalisedErrorIsWithinItsInterval) {
  double window_sum = 0;
  double batch_sum = 0;
  double apart = 0;  // window and batch, in standard deviations
  for (int seed = 1; seed <= kRuns; ++seed) {
    SimulationOptions options;
    options.duration_s = 8;
    options.camera_rate_hz = 10;  // the claim is of runs, not of their frames
    options.corner_sigma_px = 0.2;
    options.seed = options.trajectory.seed = static_cast<std::uint64_t>(seed);
    const test::WindowRecording r = test::recordingOf(options, options.corner_sigma_px);
    const auto window = test::windowOver(r, 30);
    ASSERT_TRUE(window) << "seed " << seed;
    const auto information =
        calibrationInformation(window->knowledge()->information, false).value();
    const Vector6d error = boxminus(window->estimate().T_SC0, r.truth.T_SC0);
    window_sum += error.dot(information * error);
    const CameraImuEstimate batch = test::solvedWithOffsetHeld(r.problem, r.truth);
    const Eigen::MatrixXd all = test::batchInformation(r.problem, batch);
    const Vector6d batch_error = boxminus(batch.T_SC0, r.truth.T_SC0);
    batch_sum += batch_error.dot(all * batch_error);
    const Vector6d d = boxminus(window->estimate().T_SC0, batch.T_SC0);
    apart = std::max(apart, std::sqrt(d.dot(all * d)));
  }
  RecordProperty("window", std::to_string(window_sum / kRuns));
  RecordProperty("batch", std::to_string(batch_sum / kRuns));
  RecordProperty("apart", std::to_string(apart));
  EXPECT_GT(window_sum / kRuns, kLowest);
  EXPECT_LT(window_sum / kRuns, kHighest);
  EXPECT_LT(apart, 1);
}

}  // namespace
}  // namespace plumbline
