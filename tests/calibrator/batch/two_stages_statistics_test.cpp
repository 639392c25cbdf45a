// SPDX-License-Identifier: BSD-3-Clause
// T_SC0 with cameras that were estimated from the same recording: what their errors add is in its
// covariance. White noise, seeds 1 to 24, the noise that was simulated.
#include <Eigen/Cholesky>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calibrator/base/statistics.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/two_stages.h"
#include "tests/calibrator/batch/camera_imu_examples.h"

namespace plumbline {
namespace {

constexpr int kRuns = 24;
constexpr double kSigma = 0.2;  // [px]
using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

struct Run {
  Vector7d error;
  Matrix7d own;    ///< formal, of the camera-IMU batch alone
  Matrix7d total;  ///< and what the cameras' adds
  Vector7d robust_ratio;
};

Run runOf(int seed, const TargetTerms& board) {
  SimulationOptions simulation = testing::noisyRecording(static_cast<std::uint64_t>(seed), 20);
  simulation.trajectory.seed = static_cast<std::uint64_t>(seed);
  simulation.camera_rate_hz = 5;
  simulation.target.shape.terms = board;
  SimulatedSession s = testing::simulate(simulation);
  s.session.cameras.resize(1);  // one camera: T_SC0 leans on its principal point
  s.truth.cameras.resize(1);
  CameraStageOptions cameras;
  cameras.cauchy_px = 0;
  cameras.pixel_sigma = kSigma;
  cameras.target = board.isZero(0) ? TargetMode::kGiven : TargetMode::kEstimate;
  const auto first = calibrateCameras(s.session, cameras);
  EXPECT_TRUE(first.ok()) << seed;
  s.session.target.shape = first->target;
  const auto second =
      calibrateCameraImu(s.session, first->cameras, testing::matchedOptions(s, kSigma));
  EXPECT_TRUE(second.ok()) << seed;
  // Formal in both stages; with a bent board the cameras' part alone is at hand.
  const auto added = covarianceOfCameras(
      *second, board.isZero(0) ? first->summary.covariance.matrix : first->robust_covariance);
  EXPECT_TRUE(added) << seed;
  Run run;
  run.error = testing::calibrationError(s, *second);
  run.own = second->summary.covariance.matrix;
  run.total = run.own + *added;
  const auto robust = robustStdOfBothStages(*first, *second);
  EXPECT_TRUE(robust) << seed;
  run.robust_ratio = robust->cwiseQuotient(run.total.diagonal().cwiseSqrt());
  return run;
}

/// Of T_SC0.
double nees(const Vector7d& error, const Matrix7d& covariance) {
  return error.head<6>().dot(covariance.topLeftCorner<6, 6>().llt().solve(error.head<6>()));
}

struct Sums {
  double own = 0, total = 0;
  std::vector<double> ratios;
};

Sums sumsOver(const TargetTerms& board) {
  Sums sums;
  for (int seed = 1; seed <= kRuns; ++seed) {
    const Run run = runOf(seed, board);
    sums.own += nees(run.error, run.own);
    sums.total += nees(run.error, run.total);
    for (const double ratio : run.robust_ratio) sums.ratios.push_back(ratio);
  }
  return sums;
}

// Quantiles 0.0005 and 0.9995 of chi-square with 144 degrees of freedom.
constexpr double kLow = 94.6, kHigh = 206.5;

TEST(TwoStagesStatistics, TheLeverArmsCovarianceHoldsTheCamerasErrors) {
  const Sums sums = sumsOver(TargetTerms::Zero());
  RecordProperty("nees_own", fmt::format("{:.1f}", sums.own));
  RecordProperty("nees_total", fmt::format("{:.1f}", sums.total));
  RecordProperty("robust_ratio", fmt::format("{:.3f}", median(sums.ratios)));
  EXPECT_GT(sums.total, kLow);
  EXPECT_LT(sums.total, kHigh);
  EXPECT_GT(sums.own, kHigh);  // without what the cameras add it promises too much
  EXPECT_GT(median(sums.ratios), 0.9);
  EXPECT_LT(median(sums.ratios), 1.1);
}

TEST(TwoStagesStatistics, AndThoseOfTheBoard) {
  TargetTerms board;
  board << 4e-4, -1.5e-4, 0, 0.2e-4, -1e-4, 0, 2e-4, 0, -3e-4, 0.5e-4, -1e-4, 0;
  const Sums sums = sumsOver(board);
  RecordProperty("nees_own", fmt::format("{:.1f}", sums.own));
  RecordProperty("nees_total", fmt::format("{:.1f}", sums.total));
  EXPECT_GT(sums.total, kLow);
  EXPECT_LT(sums.total, kHigh);
}

}  // namespace
}  // namespace plumbline
