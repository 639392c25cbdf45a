// SPDX-License-Identifier: BSD-3-Clause
// T_SC0 with cameras that were estimated from the same recording: what their errors add is in its
// covariance. White noise, seeds 1 to 24, the noise that was simulated.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/two_stages.h"
#include "tests/calibrator/batch/camera_imu_examples.h"

namespace plumbline {
namespace {

constexpr int kStagesRuns = 24;
constexpr double kStagesSigma = 0.2;  // [px]
using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

struct Run {
  Vector7d error;
  Matrix7d own;    ///< formal, of the camera-IMU batch alone
  Matrix7d total;  ///< and what the cameras' adds
  Vector7d robust_ratio;
};

Run runOf(int seed, const TargetTerms& board) {
  SimulationOptions simulation = test::noisyRecording(static_cast<std::uint64_t>(seed), 20);
  simulation.trajectory.seed = static_cast<std::uint64_t>(seed);
  simulation.camera_rate_hz = 5;
  simulation.target.shape.terms = board;
  SimulatedRig rig = simulatedRig("euroc");
  rig.calibration.cameras.resize(1);  // one camera: T_SC0 leans on its principal point
  SimulatedSession s = simulateSession(rig, simulation);
  CameraStageOptions cameras;
  cameras.cauchy_px = 0;
  cameras.pixel_sigma = kStagesSigma;
  cameras.target = board.isZero(0) ? TargetMode::kGiven : TargetMode::kEstimate;
  const auto first = calibrateCameras(s.session, cameras);
  EXPECT_TRUE(first.ok()) << seed;
  s.session.target.shape = first->target;
  const auto second =
      calibrateCameraImu(s.session, first->cameras, test::matchedOptions(s, kStagesSigma));
  EXPECT_TRUE(second.ok()) << seed;
  // Formal in both stages; with a bent board the cameras' part alone is at hand.
  const Eigen::MatrixXd& cameras_covariance =
      board.isZero(0) ? first->summary.covariance.matrix : first->robust_covariance->matrix;
  Run run;
  run.error = test::calibrationError(s, *second);
  run.own = second->summary.covariance.matrix;
  run.total = run.own + test::addedByCameras(*second, cameras_covariance);
  const auto robust = robustDeviationsOfBothStages(*first, *second);
  EXPECT_TRUE(robust) << seed;
  run.robust_ratio = robust->std.cwiseQuotient(run.total.diagonal().cwiseSqrt());
  return run;
}

/// Of T_SC0.
double nees(const Vector7d& error, const Matrix7d& covariance) {
  return error.head<6>().dot(covariance.topLeftCorner<6, 6>().llt().solve(error.head<6>()));
}

struct StagesSums {
  double own = 0, total = 0;
  std::vector<double> ratios;
};

StagesSums sumsOver(const TargetTerms& board) {
  StagesSums sums;
  for (int seed = 1; seed <= kStagesRuns; ++seed) {
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
  const StagesSums sums = sumsOver(TargetTerms::Zero());
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
  const StagesSums sums = sumsOver(board);
  RecordProperty("nees_own", fmt::format("{:.1f}", sums.own));
  RecordProperty("nees_total", fmt::format("{:.1f}", sums.total));
  EXPECT_GT(sums.total, kLow);
  EXPECT_LT(sums.total, kHigh);
}

struct SolvedStages {
  SimulatedSession simulated;
  CameraStageOptions camera_options;
  CameraImuOptions camera_imu_options;
  CameraStageResult camera;
  CameraImuStageResult camera_imu;
};

/// One camera on a bent board, both of which are estimated.
SolvedStages bentBoard() {
  SimulationOptions simulation = test::noisyRecording(1, 20);
  simulation.camera_rate_hz = 5;
  simulation.target.shape.terms << 4e-4, -1.5e-4, 0, 0.2e-4, -1e-4, 0, 2e-4, 0, -3e-4, 0.5e-4,
      -1e-4, 0;
  SolvedStages out{test::simulate(simulation), {}, {}, {}, {}};
  out.simulated.session.cameras.resize(1);
  out.simulated.truth.cameras.resize(1);
  out.camera_options.cauchy_px = 0;
  out.camera_options.pixel_sigma = kStagesSigma;
  out.camera_options.target = TargetMode::kEstimate;
  out.camera_imu_options = test::matchedOptions(out.simulated, kStagesSigma);
  out.camera = calibrateCameras(out.simulated.session, out.camera_options).value();
  Session placed = out.simulated.session;
  placed.target.shape = out.camera.target;
  out.camera_imu = calibrateCameraImu(placed, out.camera.cameras, out.camera_imu_options).value();
  return out;
}

/// Mean over T_SC0 of the log of one spread over the other, as a factor.
double factor(const Eigen::VectorXd& of, const Eigen::VectorXd& over) {
  return std::exp((of.head<6>().array() / over.head<6>().array()).log().mean());
}

TEST(TwoStagesStatistics, TheBootstrapDrawsCamerasAndBoardToo) {
  const SolvedStages s = bentBoard();
  ResampleOptions resample;
  resample.draws = 30;
  resample.segments = 10;
  const auto both = [&] {
    return resampleBothStages(s.simulated.session, s.camera, s.camera_imu, resample,
                              s.camera_options, s.camera_imu_options);
  };
  const auto through = both();
  Session placed = s.simulated.session;
  placed.target.shape = s.camera.target;
  const auto held = resampleCameraImu(placed, s.camera_imu, resample, s.camera_imu_options);
  ASSERT_TRUE(through && held);
  const auto total = robustDeviationsOfBothStages(s.camera, s.camera_imu);
  ASSERT_TRUE(total);
  RecordProperty("factor", fmt::format("{:.2f}", factor(through->std, total->std)));
  RecordProperty("held", fmt::format("{:.2f}", factor(held->std, total->std)));
  // Ten segments are few and unlike: the spread is of the size of the deviations.
  EXPECT_GT(factor(through->std, total->std), 0.6);
  EXPECT_LT(factor(through->std, total->std), 1.8);
  EXPECT_LT(factor(held->std, through->std), 0.8);  // knows nothing of cameras and board
  resample.threads = 3;
  const auto again = both();
  ASSERT_TRUE(again);
  EXPECT_EQ(again->draws, through->draws);
}

// A sum's degrees of freedom lie between those of the part with the fewest and those of both.
TEST(TwoStagesStatistics, DegreesOfFreedomAreThoseOfBothStages) {
  const SolvedStages s = bentBoard();
  const auto total = robustDeviationsOfBothStages(s.camera, s.camera_imu);
  ASSERT_TRUE(total && s.camera_imu.faults->robust_dof);
  const RobustCovariance& cameras = *s.camera.robust_covariance;
  const Eigen::MatrixXd& J = s.camera_imu.faults->by_cameras;
  for (Eigen::Index k = 0; k < 7; ++k) {
    Eigen::VectorXd response = Eigen::VectorXd::Zero(cameras.matrix.rows());
    response.head(J.cols()) = J.row(k).transpose();
    const double of_cameras = cameras.degrees.of(response);
    const double own = (*s.camera_imu.faults->robust_dof)(k);
    EXPECT_GE(total->dof(k), std::min(own, of_cameras) * (1 - 1e-9)) << k;
    EXPECT_LE(total->dof(k), (own + of_cameras) * (1 + 1e-9)) << k;
    EXPECT_GT(own, 1) << k;
    EXPECT_LT(own, 20) << k;  // blocks of a second
    EXPECT_GT(of_cameras, 1) << k;
    EXPECT_LT(of_cameras, 40) << k;
  }
}

TEST(TwoStagesStatistics, SegmentsLieWhereTheOtherStagesDo) {
  const auto frames = [](const std::vector<TimeNs>& stamps) {
    std::vector<Frame> out;
    for (const TimeNs t : stamps) out.push_back({t, {}});
    return out;
  };
  const auto segments =
      segmentsAtTheSameTime({{0, 2, 1}, {2, 1, 3}, {3, 1, 2}}, frames({10, 20, 30, 40}),
                            frames({5, 12, 20, 29, 30, 41, 50}));
  ASSERT_EQ(segments.size(), 3U);
  EXPECT_EQ(segments[0].first, 0);  // what stands before the first frame belongs to it
  EXPECT_EQ(segments[0].count, 4);
  EXPECT_EQ(segments[1].first, 4);
  EXPECT_EQ(segments[1].count, 1);
  EXPECT_EQ(segments[1].weight, 3);
  EXPECT_EQ(segments[2].count, 2);
  // A segment without frames of this stage is left out.
  EXPECT_TRUE(segmentsAtTheSameTime({{1, 1, 1}}, frames({10, 20, 30}), frames({5, 35})).empty());
}

}  // namespace
}  // namespace plumbline
