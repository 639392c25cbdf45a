// SPDX-License-Identifier: BSD-3-Clause
// The covariance of a batch whose measurements have other noise than their weights assume.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/batch/camera_imu/stage.h"
#include "tests/calibrator/batch/camera_imu_examples.h"

namespace plumbline {
namespace {

struct CovarianceCase {
  SimulatedSession simulated;
  CameraImuOptions options;
  CameraImuStageResult result;

  explicit CovarianceCase(const SimulationOptions& recording)
      : simulated(test::simulate(recording)),
        options(test::matchedOptions(simulated, 0.2)),
        result(calibrateCameraImu(simulated.session, simulated.truth.cameras, options).value()) {}
  SolvedCameraImu solved() const { return solvedBatch(simulated.session, result, options); }
};

/// In standard deviations of b.
double relative(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::VectorXd scale = b.diagonal().cwiseSqrt().cwiseInverse();
  return (scale.asDiagonal() * (a - b) * scale.asDiagonal()).norm();
}

TEST(CameraImuCovariance, OfTheNoiseAssumedIsTheBatchs) {
  const CovarianceCase c(test::noisyRecording(3));
  EXPECT_LT(relative(*covarianceUnder(c.solved(), {}), c.result.summary.covariance.matrix), 1e-3);
}

TEST(CameraImuCovariance, IsFourTimesItselfUnderTwiceTheNoise) {
  const CovarianceCase c(test::exactRecording(200));
  const Eigen::MatrixXd assumed = *covarianceUnder(c.solved(), {});
  EXPECT_LT(relative(*covarianceUnder(c.solved(), {2, 2, 2, 2, 2, 2}), 4 * assumed), 1e-4);
}

// Without the sandwich's part, which is of the samples as they are.
constexpr NoiseFactors kInformation{1, 1, 1, 1, 1, 0};

/// What the covariance gains by the noise of one group of measurements, from a derivative: with
/// A = s H_g + B, the group's part in units of s, that of A^-1 by log s is -A^-1 s H_g A^-1.
/// `scale` multiplies the group's standard deviation in the weights.
template <class Scale>
Eigen::MatrixXd shareOf(const SolvedCameraImu& solved, const Scale& scale) {
  const double h = 1e-3;
  SolvedCameraImu more = solved, less = solved;
  scale(more.problem, std::exp(h / 2));
  scale(less.problem, std::exp(-h / 2));
  return (*covarianceUnder(more, kInformation) - *covarianceUnder(less, kInformation)) / (2 * h);
}

/// `noise` makes of the covariance what the group's share, times variance - 1, adds to it.
void expectFollows(const SolvedCameraImu& solved, const Eigen::MatrixXd& share,
                   NoiseFactors (*noise)(double factor)) {
  const Eigen::MatrixXd assumed = *covarianceUnder(solved, kInformation);
  for (const double factor : {0.2, 2.0}) {
    const Eigen::MatrixXd expected = assumed + (factor * factor - 1) * share;
    EXPECT_LT(relative(*covarianceUnder(solved, noise(factor)), expected), 1e-3) << factor;
  }
}

TEST(CameraImuCovariance, FollowsTheCornersShare) {
  const CovarianceCase c(test::exactRecording(200));
  const SolvedCameraImu solved = c.solved();
  const Eigen::MatrixXd share = shareOf(
      solved, [](CameraImuProblem& problem, double factor) { problem.pixel_sigma *= factor; });
  EXPECT_GT(share(0, 0) / (*covarianceUnder(solved, {}))(0, 0), 0.02);
  expectFollows(solved, share, [](double factor) { return NoiseFactors{factor, 1, 1, 1, 1, 0}; });
}

TEST(CameraImuCovariance, FollowsTheShareOfTheImusNoise) {
  const CovarianceCase c(test::exactRecording(200));
  const SolvedCameraImu solved = c.solved();
  const Eigen::MatrixXd share = shareOf(solved, [](CameraImuProblem& problem, double factor) {
    problem.noise.gyro_density *= factor;
    problem.noise.accel_density *= factor;
  });
  EXPECT_GT(share(0, 0) / (*covarianceUnder(solved, {}))(0, 0), 0.02);
  expectFollows(solved, share,
                [](double factor) { return NoiseFactors{1, factor, factor, 1, 1, 0}; });
}

TEST(CameraImuCovariance, FollowsTheShareOfTheBiases) {
  const CovarianceCase c(test::exactRecording(200));
  const SolvedCameraImu solved = c.solved();
  const Eigen::MatrixXd share = shareOf(solved, [](CameraImuProblem& problem, double factor) {
    problem.noise.gyro_random_walk *= factor;
    problem.noise.accel_random_walk *= factor;
  });
  expectFollows(solved, share,
                [](double factor) { return NoiseFactors{1, 1, 1, factor, factor, 0}; });
}

TEST(SolvedBatch, LeavesOutTheCornersThatTheResultLeftOut) {
  const SimulatedSession s = test::simulate(test::noisyRecording(3, 3));
  CameraImuOptions options = test::matchedOptions(s, 0.2);
  options.filter = CornerFilter::kSigma;
  options.filter_sigmas = 2;
  options.diagnose_faults = false;
  const auto result = calibrateCameraImu(s.session, s.truth.cameras, options);
  ASSERT_TRUE(result);
  const CameraImuProblem problem = solvedBatch(s.session, *result, options).problem;
  double used = 0, all = 0;
  for (const Frame& frame : problem.frames) {
    for (std::size_t c = 0; c < problem.corners.size(); ++c) {
      if (frame.view[c] < 0) continue;
      used += problem.corners[c].view(frame.view[c]).used();
      all += problem.corners[c].view(frame.view[c]).count;
    }
  }
  EXPECT_EQ(used, static_cast<double>(result->summary.corners_used));
  EXPECT_LT(used, 0.95 * all);
}

// Whatever the margin would leave out under the offset found; and across a pause of the IMU.
TEST(SolvedBatch, HoldsEveryFrameAndLinkOfTheResult) {
  SimulatedSession s = test::simulate(test::noisyRecording(3));
  auto& samples = s.session.imu->samples;
  const TimeNs pause = samples[samples.size() / 2].t;
  std::erase_if(samples,
                [&](const ImuSample& a) { return a.t > pause && a.t < pause + 300'000'000; });
  CameraImuOptions options = test::matchedOptions(s, 0.2);
  options.diagnose_faults = false;
  const auto result = calibrateCameraImu(s.session, s.truth.cameras, options);
  ASSERT_TRUE(result);
  options.margin_s = 1;
  const SolvedCameraImu solved = solvedBatch(s.session, *result, options);
  const auto& links = solved.problem.links;
  EXPECT_EQ(solved.problem.frames.size(), result->frames.size());
  EXPECT_EQ(solved.estimate.states.size(), result->frames.size());
  EXPECT_EQ(links.size() + 1, result->frames.size());
  EXPECT_EQ(std::count(links.begin(), links.end(), FrameLink::kBiasWalk), 1);
}

}  // namespace
}  // namespace plumbline
