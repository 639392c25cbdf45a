// SPDX-License-Identifier: BSD-3-Clause
// The covariance of a batch whose corners have another noise than their weights assume.
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

double relative(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::VectorXd scale = b.diagonal().cwiseSqrt().cwiseInverse();
  return (scale.asDiagonal() * (a - b) * scale.asDiagonal()).norm();
}

TEST(CameraImuCovariance, OfTheNoiseAssumedIsTheBatchs) {
  const CovarianceCase c(test::noisyRecording(3));
  EXPECT_LT(relative(*covarianceUnder(c.solved(), 1), c.result.summary.covariance.matrix), 1e-3);
}

// With A = s C + B, the corners' part in units of s, the derivative of A^-1 by log s is
// -A^-1 s C A^-1: what a change of the assumed noise alone makes of the covariance tells the
// corners' share. Without noise, since the sandwich's part does not follow.
TEST(CameraImuCovariance, FollowsTheCornersShare) {
  const CovarianceCase c(test::exactRecording(200));
  SolvedCameraImu solved = c.solved();
  const Eigen::MatrixXd assumed = *covarianceUnder(solved, 1);
  const auto withSigma = [&](double factor) {
    SolvedCameraImu other = solved;
    other.problem.pixel_sigma *= factor;
    return *covarianceUnder(other, 1);
  };
  const double h = 1e-3;
  const Eigen::MatrixXd share =
      (withSigma(std::exp(h / 2)) - withSigma(std::exp(-h / 2))) / (2 * h);
  EXPECT_GT(relative(assumed + share, assumed), 0.1);
  for (const double variance : {0.0, 0.04, 4.0}) {
    const Eigen::MatrixXd expected = assumed + (variance - 1) * share;
    EXPECT_LT(relative(*covarianceUnder(solved, variance), expected), 1e-4) << variance;
  }
}

}  // namespace
}  // namespace plumbline
