// SPDX-License-Identifier: BSD-3-Clause
// The covariance is a claim: over 100 seeds the normalised errors must be as large as it says.
#include <Eigen/Cholesky>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/simulate/simulate_session.h"

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

/// Summed normalised errors of the blocks of a stereo rig.
struct Sums {
  double intrinsics[2] = {0, 0};
  double extrinsics = 0;
  int failures = 0;
};

Sums sumOver(const std::string& rig) {
  Sums sums;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    SimulationOptions recording;
    recording.seed = static_cast<std::uint64_t>(seed);
    recording.duration_s = 12;
    recording.camera_rate_hz = 2.5;  // the claim is of runs, not of their frames
    recording.corner_sigma_px = kSigma;
    const SimulatedSession s = simulateSession(simulatedRig(rig), recording);
    CameraStageOptions options;
    options.cauchy_px = 0;
    options.pixel_sigma = kSigma;
    const auto result = calibrateCameras(s.session, options);
    if (!result) {
      ++sums.failures;
      continue;
    }
    const Eigen::VectorXd error = cameraDifference(result->cameras, s.truth.cameras);
    const Eigen::MatrixXd& covariance = result->summary.covariance.matrix;
    for (int c = 0; c < 2; ++c) {
      sums.intrinsics[c] += nees(error.segment(8 * c, 8), covariance.block(8 * c, 8 * c, 8, 8));
    }
    sums.extrinsics += nees(error.tail(6), covariance.bottomRightCorner(6, 6));
  }
  return sums;
}

TEST(CameraStatistics, NormalisedErrorsOfAHundredSeedsAreChiSquare) {
  for (const char* rig : {"euroc", "tumvi"}) {
    const Sums sums = sumOver(rig);
    EXPECT_EQ(sums.failures, 0) << rig;
    checkSum(rig, sums.intrinsics[0], 8);
    checkSum(rig, sums.intrinsics[1], 8);
    checkSum(rig, sums.extrinsics, 6);
    RecordProperty(
        std::string(rig) + "_nees_per_dof",
        fmt::format("cam0 {:.4f} cam1 {:.4f} T_C0C1 {:.4f}", sums.intrinsics[0] / (8 * kSeeds),
                    sums.intrinsics[1] / (8 * kSeeds), sums.extrinsics / (6 * kSeeds)));
  }
}

}  // namespace
}  // namespace plumbline
