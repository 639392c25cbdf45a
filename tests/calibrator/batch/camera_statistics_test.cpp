// SPDX-License-Identifier: BSD-3-Clause
// The covariance is a claim: over 100 seeds the normalised errors must be as large as it says.
#include <Eigen/Cholesky>
#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/batch/camera_batch.h"
#include "calibrator/simulate/simulate_session.h"
#include "tests/calibrator/oracle/camera_oracle.h"

namespace plumbline {
namespace {

constexpr int kSeeds = 100;
constexpr double kSigma = 0.3;  // [px]

/// Quantile of chi-square by Wilson and Hilferty; z is the normal quantile.
double chiSquareQuantile(double dof, double z) {
  const double a = 2 / (9 * dof);
  return dof * std::pow(1 - a + z * std::sqrt(a), 3);
}

double nees(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
  return error.dot(covariance.llt().solve(error));
}

void checkSum(const char* block, double sum, int dimension) {
  const double z = 3.2905;  // two-sided 99.9 %
  EXPECT_GT(sum, chiSquareQuantile(kSeeds * dimension, -z)) << block;
  EXPECT_LT(sum, chiSquareQuantile(kSeeds * dimension, z)) << block;
}

TEST(CameraStatistics, NormalisedErrorsOfAHundredSeedsAreChiSquare) {
  for (const char* rig : {"euroc", "tumvi"}) {
    double intrinsics = 0;
    double extrinsics = 0;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      SimulationOptions recording;
      recording.seed = static_cast<std::uint64_t>(seed);
      recording.duration_s = 12;
      recording.camera_rate_hz = 5;
      recording.corner_sigma_px = kSigma;
      const SimulatedSession s = simulateSession(simulatedRig(rig), recording);
      CameraStageOptions options;
      options.cauchy_px = 0;
      options.pixel_sigma = kSigma;
      const auto result = calibrateCameras(s.session, options);
      ASSERT_TRUE(result.ok()) << rig << " seed " << seed << ": " << result.failure().message;
      const Eigen::VectorXd error =
          oracle::difference({result->cameras, {}}, {s.truth.cameras, {}});
      const Eigen::MatrixXd& covariance = result->summary.covariance.matrix;
      intrinsics += nees(error.head(16), covariance.topLeftCorner(16, 16));
      extrinsics += nees(error.tail(6), covariance.bottomRightCorner(6, 6));
    }
    checkSum(rig, intrinsics, 16);
    checkSum(rig, extrinsics, 6);
  }
}

}  // namespace
}  // namespace plumbline
