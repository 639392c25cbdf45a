// SPDX-License-Identifier: BSD-3-Clause
// What is reported of single intervals of the IMU and of all together, by hand.
#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/batch/camera_imu/stage.h"

namespace plumbline {
namespace {

constexpr double kSpan = 0.1;  // [s] between the two frames
const Eigen::Vector3d kGyroReading(0.02, -0.01, 0.03);
const Eigen::Vector3d kAccelReading(1, -2, 9);

/// A sensor that reads the same all along, its rate being its bias: it does not turn.
CameraImuProblem constantReadings() {
  CameraImuProblem problem;
  for (int k = 0; k <= 40; ++k) {
    problem.samples.push_back({k * 5'000'000, kGyroReading, kAccelReading});
  }
  problem.frames = {{50'000'000, {}}, {150'000'000, {}}};
  problem.weights = {1, 1};
  problem.links = {FrameLink::kInertial};
  problem.noise.gyro_density = 1e-6;  // so little that it turns no force
  problem.noise.accel_density = 2e-3;
  return problem;
}

/// States that turn at `rate` in S and accelerate by `a` in F.
CameraImuEstimate movingStates(const Eigen::Vector3d& rate, const Eigen::Vector3d& a) {
  CameraImuEstimate estimate;
  ImuState i;
  i.T_FS = {expSO3({0.4, -0.7, 0.2}), Eigen::Vector3d(1, 2, 3)};
  i.v_F << 0.3, 0.1, -0.2;
  i.gyro_bias = kGyroReading;
  i.accel_bias << 0.05, 0.1, -0.2;
  ImuState j = i;
  j.T_FS.R = i.T_FS.R * expSO3(kSpan * rate);
  j.v_F = i.v_F + kSpan * a;
  estimate.states = {i, j};
  return estimate;
}

TEST(ImuIntervalResiduals, ReadingsAreTheSamplesMeansAndWhatTheStatesPredictOfThem) {
  const CameraImuProblem problem = constantReadings();
  const Eigen::Vector3d rate(0.5, -0.3, 0.2), a(2, 0, -1);
  const CameraImuEstimate estimate = movingStates(rate, a);
  const auto weights = imuWeights(problem, estimate);
  ASSERT_TRUE(weights);
  const auto residuals = imuIntervalResiduals(problem, estimate, *weights);
  ASSERT_EQ(residuals.size(), 1U);
  const ImuIntervalResidual& r = residuals[0];
  EXPECT_EQ(r.t, 50'000'000);
  EXPECT_DOUBLE_EQ(r.dt_s, kSpan);
  // Both with the biases in them, as the sensor reads.
  EXPECT_LT((r.gyro.measured - kGyroReading).norm(), 1e-12);
  EXPECT_LT((r.gyro.predicted - (rate + kGyroReading)).norm(), 1e-12);
  EXPECT_LT((r.accel.measured - kAccelReading).norm(), 1e-12);
  const ImuState& i = estimate.states[0];
  const Eigen::Vector3d down(0, 0, -problem.gravity_m_s2);
  EXPECT_LT((r.accel.predicted - (i.T_FS.R.transpose() * (a - down) + i.accel_bias)).norm(), 1e-12);
  // The mean of white noise of a density over a time.
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(r.gyro.std(axis), 1e-6 / std::sqrt(kSpan), 1e-12);
    EXPECT_NEAR(r.accel.std(axis), 2e-3 / std::sqrt(kSpan), 1e-7);
  }
}

TEST(ImuIntervalResiduals, ThereAreNoneAcrossLinksThatAreNotInertial) {
  CameraImuProblem problem = constantReadings();
  const CameraImuEstimate estimate = movingStates({0, 0, 0}, {0, 0, 0});
  const auto weights = imuWeights(problem, estimate);
  ASSERT_TRUE(weights);
  for (const FrameLink link : {FrameLink::kBiasWalk, FrameLink::kBroken}) {
    problem.links = {link};
    EXPECT_TRUE(imuIntervalResiduals(problem, estimate, *weights).empty());
  }
}

TEST(SummariseIntervals, RootsOfMeansPerIntervalAndPerComponent) {
  ImuIntervalResidual a, b;
  a.dt_s = 0.1;
  a.rotation_rad << 0.003, 0, 0.004;  // 0.05 rad/s
  a.velocity_m_s << 0, 0.2, 0;        // 2 m/s^2
  a.normalised << 3, 3, 3, 2, 2, 2, 2, 2, 2, 0.5, 0.5, 0.5, 1, 1, 1;
  b = a;
  b.dt_s = 0.2;  // half of both
  b.normalised *= 2;
  const ImuResidualSummary s = summarise({a, b});
  EXPECT_DOUBLE_EQ(s.gyro_rms_rad_s, std::sqrt((0.05 * 0.05 + 0.025 * 0.025) / 2));
  EXPECT_DOUBLE_EQ(s.accel_rms_m_s2, std::sqrt((4.0 + 1) / 2));
  const double both = std::sqrt((1.0 + 4) / 2);
  EXPECT_DOUBLE_EQ(s.gyro_normalised_rms, 3 * both);
  EXPECT_DOUBLE_EQ(s.accel_normalised_rms, 2 * both);
  EXPECT_DOUBLE_EQ(s.gyro_bias_normalised_rms, 0.5 * both);
  EXPECT_DOUBLE_EQ(s.accel_bias_normalised_rms, both);
  EXPECT_DOUBLE_EQ(s.chi2, a.normalised.squaredNorm() + b.normalised.squaredNorm());
  EXPECT_EQ(s.dof, 30);
}

}  // namespace
}  // namespace plumbline
