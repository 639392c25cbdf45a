// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

using Eigen::Vector3d;

SimulationOptions quietOptions() {
  SimulationOptions o;
  o.duration_s = 2;
  o.camera_rate_hz = 1;
  o.imu_noise = false;
  o.initial_gyro_bias.setZero();
  o.initial_accel_bias.setZero();
  return o;
}

// The definition of the samples: integrating gyro and specific force (midpoint rule over pairs of
// samples at 4 kHz, error of order dt^2 = 2.5e-7) returns to the trajectory.
TEST(SimulateImu, IntegratingTheSamplesReturnsToTheTrajectory) {
  SimulationOptions o = quietOptions();
  o.imu_rate_hz = 4000;
  const SimulatedSession s = simulateSession(simulatedRig("euroc"), o);
  const auto& samples = s.session.imu->samples;
  const MotionState start = s.motionAtImuTime(samples.front().t);
  Transform T = start.T_FB;
  Vector3d v = start.v_F;
  std::size_t i = 0;
  for (; i + 2 < samples.size(); i += 2) {
    const double dt = secondsBetween(samples[i].t, samples[i + 2].t);
    const ImuSample& middle = samples[i + 1];
    const Eigen::Matrix3d R_middle = T.R * expSO3(0.5 * dt * middle.gyro);
    const Vector3d a = R_middle * middle.accel + s.gravity_F;
    T.t += dt * v + 0.5 * dt * dt * a;
    v += dt * a;
    T.R = T.R * expSO3(dt * middle.gyro);
  }
  const MotionState end = s.motionAtImuTime(samples[i].t);
  EXPECT_GT((end.T_FB.t - start.T_FB.t).norm(), 0.1);
  EXPECT_LE(rotationAngle(T.R.transpose() * end.T_FB.R), 2e-6);
  EXPECT_LE((v - end.v_F).norm(), 1e-5);
  EXPECT_LE((T.t - end.T_FB.t).norm(), 2e-5);
}

TEST(SimulateImu, RestingAccelerometerReadsGravityUpwards) {
  SimulationOptions o = quietOptions();
  o.trajectory.kind = MotionKind::kStatic;
  const SimulatedSession s = simulateSession(simulatedRig("euroc"), o);
  const ImuSample& sample = s.session.imu->samples.front();
  const Vector3d up_F = s.states.front().T_FS.R * sample.accel;
  EXPECT_NEAR(up_F.norm(), 9.80655, 1e-12);
  EXPECT_GT(up_F.y(), 9.7);  // the target stands upright: y of F points up
  EXPECT_EQ(sample.gyro.norm(), 0);
}

TEST(SimulateImu, BiasesAreAddedToTheSamples) {
  SimulationOptions o = quietOptions();
  const SimulatedSession without = simulateSession(simulatedRig("d435i"), o);
  o.initial_gyro_bias = {0.01, 0.02, -0.03};
  o.initial_accel_bias = {0.1, -0.2, 0.3};
  const SimulatedSession with = simulateSession(simulatedRig("d435i"), o);
  for (std::size_t i = 0; i < with.biases.size(); ++i) {
    const ImuSample& a = with.session.imu->samples[i];
    const ImuSample& b = without.session.imu->samples[i];
    ASSERT_LE((a.gyro - b.gyro - o.initial_gyro_bias).norm(), 1e-15);
    ASSERT_LE((a.accel - b.accel - o.initial_accel_bias).norm(), 1e-14);
  }
}

/// Sum of squares of the components of differences, to be compared with n * sigma^2.
struct SquareSum {
  double gyro = 0;
  double accel = 0;
  std::size_t count = 0;
};

// n squared standard normals sum up to n +- sqrt(2 n) (chi-square); the bounds are 4 of those.
TEST(SimulateImu, NoiseHasTheStatedDensities) {
  SimulationOptions o;
  o.duration_s = 60;
  o.camera_rate_hz = 0.1;
  const SimulatedSession s = simulateSession(simulatedRig("euroc"), o);
  const ImuNoise noise = s.truth.imu->noise;
  SquareSum white, walk;
  const auto& samples = s.session.imu->samples;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const MotionState m = s.motionAtImuTime(samples[i].t);
    const Vector3d force = m.T_FB.R.transpose() * (m.a_F - s.gravity_F);
    white.gyro += (samples[i].gyro - m.omega_B - s.biases[i].gyro).squaredNorm();
    white.accel += (samples[i].accel - force - s.biases[i].accel).squaredNorm();
    walk.gyro += (s.biases[i].gyro - s.biases[i - 1].gyro).squaredNorm();
    walk.accel += (s.biases[i].accel - s.biases[i - 1].accel).squaredNorm();
  }
  const double n = 3.0 * static_cast<double>(samples.size() - 1);
  const double bound = 4 * std::sqrt(2 * n);
  const auto variance = [](double density, double factor) { return density * density * factor; };
  EXPECT_NEAR(white.gyro / variance(noise.gyro_density, noise.rate_hz), n, bound);
  EXPECT_NEAR(white.accel / variance(noise.accel_density, noise.rate_hz), n, bound);
  EXPECT_NEAR(walk.gyro / variance(noise.gyro_random_walk, 1 / noise.rate_hz), n, bound);
  EXPECT_NEAR(walk.accel / variance(noise.accel_random_walk, 1 / noise.rate_hz), n, bound);
}

TEST(SimulateImu, RatesAndStampsAreExact) {
  for (const double rate : {200.0, 400.0, 333.0}) {
    SimulationOptions o = quietOptions();
    o.imu_rate_hz = rate;
    const SimulatedSession s = simulateSession(simulatedRig("euroc"), o);
    const auto& samples = s.session.imu->samples;
    EXPECT_EQ(s.session.imu->noise.rate_hz, rate);
    for (std::size_t i = 1; i < samples.size(); ++i) {
      const double dt = secondsBetween(samples[i - 1].t, samples[i].t);
      ASSERT_NEAR(dt, 1 / rate, 1.01e-9);  // each stamp is rounded to a nanosecond, no drift
    }
    const double span = secondsBetween(samples.front().t, samples.back().t);
    EXPECT_NEAR(span, static_cast<double>(samples.size() - 1) / rate, 1.01e-9);
  }
}

TEST(SimulateImu, LongerRecordingsKeepTheNoiseOfShorterOnes) {
  SimulationOptions o;
  o.duration_s = 2;
  const SimulatedSession brief = simulateSession(simulatedRig("euroc"), o);
  o.duration_s = 3;
  o.imu_margin_s = 1;
  const SimulatedSession longer = simulateSession(simulatedRig("euroc"), o);
  const auto& a = brief.session.imu->samples;
  const auto& b = longer.session.imu->samples;
  const std::size_t shift = 100;  // 0.5 s more margin at 200 Hz
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].t, b[i + shift].t);
    ASSERT_EQ(a[i].gyro, b[i + shift].gyro);
    ASSERT_EQ(a[i].accel, b[i + shift].accel);
  }
}

TEST(SimulateImu, SamplesCoverEveryExposureByTheMargin) {
  for (const double offset : {-0.3, 0.0, 0.3}) {
    SimulationOptions o = quietOptions();
    o.time_offset_s = offset;
    const SimulatedSession s = simulateSession(simulatedRig("euroc"), o);
    const TimeNs shift = toNanoseconds(offset);
    const auto& samples = s.session.imu->samples;
    EXPECT_GE(secondsBetween(samples.front().t, s.frame_stamps.front() + shift), 0.5);
    EXPECT_GE(secondsBetween(s.frame_stamps.back() + shift, samples.back().t), 0.5);
  }
}

TEST(SimulateImu, NegativeMarginLeavesExposuresUncovered) {
  SimulationOptions o;
  o.duration_s = 2;
  o.time_offset_s = 0;
  const SimulatedSession full = simulateSession(simulatedRig("euroc"), o);
  o.imu_margin_s = -0.3;
  const SimulatedSession cut = simulateSession(simulatedRig("euroc"), o);
  const auto& samples = cut.session.imu->samples;
  EXPECT_EQ(samples.front().t, o.start_ns + 300'000'000);
  EXPECT_EQ(samples.back().t, o.start_ns + 1'700'000'000);
  EXPECT_EQ(samples.size(), cut.biases.size());
  const std::size_t shift = 160;  // 0.8 s at 200 Hz
  EXPECT_EQ(samples[5].gyro, full.session.imu->samples[5 + shift].gyro);
}

}  // namespace
}  // namespace plumbline
