// SPDX-License-Identifier: BSD-3-Clause
// Each fault of the IMU is found again in the samples by a formula of its own, noise off.
#include "calibrator/simulate/faults/imu_faults.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "tests/calibrator/simulate/fault_recordings.h"

namespace plumbline {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::forceOf;
using test::soundRecording;
using test::withFaults;
using enum FaultKind;

const SimulatedSession& clean() {
  static const SimulatedSession session = withFaults(soundRecording(), {});
  return session;
}

const std::vector<ImuSample>& samplesOf(const SimulatedSession& s) {
  return s.session.imu->samples;
}

TEST(ImuFaults, ScalesMultiplyTheirAxisOrAll) {
  const SimulatedSession s = withFaults(
      soundRecording(),
      {{.kind = kAccelScale, .value = 1.01, .axis = 2}, {.kind = kGyroScale, .value = 0.98}});
  for (std::size_t i = 0; i < samplesOf(s).size(); ++i) {
    const ImuSample& with = samplesOf(s)[i];
    const ImuSample& without = samplesOf(clean())[i];
    ASSERT_EQ(with.accel.x(), without.accel.x());
    ASSERT_NEAR(with.accel.z(), 1.01 * without.accel.z(), 1e-13);
    ASSERT_LE((with.gyro - 0.98 * without.gyro).norm(), 1e-15);
  }
}

// A turned triad reads the same length from another side: the angle between what both read of a
// vector across the axis is that of the turn, and its sense is that of a frame turned by +angle.
TEST(ImuFaults, MisalignmentTurnsOneTriadOnly) {
  const SimulatedSession s =
      withFaults(soundRecording(), {{.kind = kAccelMisalignment, .value = kDegree, .axis = 2}});
  const Matrix3d R_SA = expSO3(Vector3d(0, 0, kDegree));
  for (std::size_t i = 0; i < samplesOf(s).size(); ++i) {
    ASSERT_EQ(samplesOf(s)[i].gyro, samplesOf(clean())[i].gyro);
    ASSERT_LE((R_SA * samplesOf(s)[i].accel - samplesOf(clean())[i].accel).norm(), 1e-13);
  }
}

TEST(ImuFaults, SkewedAxesReadTheCosinesOfTheirAngles) {
  const SimulatedSession s = withFaults(soundRecording(), {{.kind = kAxes, .value = 3 * kDegree}});
  const Vector3d x(std::cos(3 * kDegree), std::sin(3 * kDegree), 0);
  const Vector3d y(0, std::cos(3 * kDegree), std::sin(3 * kDegree));
  for (std::size_t i = 0; i < samplesOf(s).size(); ++i) {
    const Vector3d f = samplesOf(clean())[i].accel;
    const Vector3d w = samplesOf(clean())[i].gyro;
    ASSERT_LE((samplesOf(s)[i].accel - Vector3d(x.dot(f), y.dot(f), f.z())).norm(), 1e-13);
    ASSERT_LE((samplesOf(s)[i].gyro - Vector3d(x.dot(w), y.dot(w), w.z())).norm(), 1e-14);
  }
}

TEST(ImuFaults, DelayedSamplesShowTheMotionOfBefore) {
  const SimulatedSession s = withFaults(soundRecording(), {{.kind = kGyroDelay, .value = 0.005},
                                                           {.kind = kAccelDelay, .value = -0.002}});
  for (const ImuSample& sample : samplesOf(s)) {
    // motionAtImuTime() of the whole nanosecond is the same instant.
    ASSERT_LE((sample.gyro - s.motionAtImuTime(sample.t - 5'000'000).omega_B).norm(), 1e-12);
    const Vector3d force = forceOf(s.motionAtImuTime(sample.t + 2'000'000), s.gravity_F);
    ASSERT_LE((sample.accel - force).norm(), 1e-11);
  }
}

TEST(ImuFaults, GSensitivityAndVibrationAddToTheReadings) {
  const SimulatedSession s =
      withFaults(soundRecording(), {{.kind = kGSensitivity, .value = 0.002},
                                    {.kind = kVibration, .value = 2, .extent = 40, .axis = 0}});
  double energy = 0;
  for (std::size_t i = 0; i < samplesOf(s).size(); ++i) {
    const Vector3d f = samplesOf(clean())[i].accel;
    ASSERT_LE((samplesOf(s)[i].gyro - samplesOf(clean())[i].gyro - 0.002 * f).norm(), 1e-14);
    const double t_s = secondsBetween(s.start_ns, samplesOf(s)[i].t);
    const Vector3d shaken = samplesOf(s)[i].accel - f;
    ASSERT_NEAR(shaken.x(), 2 * std::sin(2 * std::numbers::pi * 40 * t_s), 1e-11);
    ASSERT_EQ(shaken.tail<2>().norm(), 0);
    energy += shaken.squaredNorm();
  }
  EXPECT_NEAR(energy / static_cast<double>(samplesOf(s).size()), 2.0, 0.02);  // A^2 / 2
}

TEST(ImuFaults, SlippedImuReadsTheSameVectorsInItsTurnedFrame) {
  const Fault slip{.kind = kSlip, .value = 0.2 * kDegree, .at_s = 2};
  const SimulatedSession s = withFaults(soundRecording(), {slip});
  const Matrix3d R_SSlipped = expSO3(slip.value * Vector3d::Ones().normalized());
  for (std::size_t i = 0; i < samplesOf(s).size(); ++i) {
    const bool after = samplesOf(s)[i].t >= s.start_ns + 2'000'000'000;
    const Matrix3d R = after ? R_SSlipped : Matrix3d::Identity();
    ASSERT_LE((R * samplesOf(s)[i].gyro - samplesOf(clean())[i].gyro).norm(), 1e-14);
    ASSERT_LE((R * samplesOf(s)[i].accel - samplesOf(clean())[i].accel).norm(), 1e-13);
  }
  // The cameras do not notice.
  EXPECT_EQ(test::cornersById(s), test::cornersById(clean()));
}

TEST(ImuFaults, BiasJumpsAreInSamplesAndBiases) {
  const SimulatedSession s =
      withFaults(soundRecording(), {{.kind = kBiasJump, .value = 0.05, .at_s = 2, .axis = 1},
                                    {.kind = kAccelBiasJump, .value = 0.5, .at_s = 3}});
  for (std::size_t i = 0; i < samplesOf(s).size(); ++i) {
    const double t_s = secondsBetween(s.start_ns, samplesOf(s)[i].t);
    const Vector3d gyro(0, t_s >= 2 ? 0.05 : 0, 0);
    const Vector3d accel = Vector3d::Constant(t_s >= 3 ? 0.5 / std::sqrt(3.0) : 0);
    ASSERT_LE((s.biases[i].gyro - gyro).norm(), 1e-15);
    ASSERT_LE((s.biases[i].accel - accel).norm(), 1e-15);
    ASSERT_LE((samplesOf(s)[i].gyro - samplesOf(clean())[i].gyro - gyro).norm(), 1e-15);
    ASSERT_LE((samplesOf(s)[i].accel - samplesOf(clean())[i].accel - accel).norm(), 1e-14);
  }
}

TEST(ImuFaults, ClippedReadingsStopAtTheLimitAndOthersStay) {
  const SimulatedSession s = withFaults(
      soundRecording(), {{.kind = kClip, .value = 9}, {.kind = kGyroClip, .value = 0.5}});
  int clipped = 0;
  for (std::size_t i = 0; i < samplesOf(s).size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const double was = samplesOf(clean())[i].accel[k];
      ASSERT_EQ(samplesOf(s)[i].accel[k], std::abs(was) > 9 ? std::copysign(9, was) : was);
      ASSERT_LE(std::abs(samplesOf(s)[i].gyro[k]), 0.5);
      clipped += std::abs(was) > 9 ? 1 : 0;
    }
  }
  EXPECT_GT(clipped, 50);
}

TEST(ImuFaults, SpikesAreAsManyAndAsLargeAsStatedAndTheirStampsAreTold) {
  SimulationOptions o = soundRecording(60);
  o.camera_rate_hz = 0.1;
  const SimulatedSession without = withFaults(o, {});
  const SimulatedSession s = withFaults(o, {{.kind = kSpike, .value = 1, .extent = 100}});
  std::vector<TimeNs> struck;
  for (std::size_t i = 0; i < samplesOf(s).size(); ++i) {
    const Vector3d spike = samplesOf(s)[i].gyro - samplesOf(without)[i].gyro;
    ASSERT_EQ(samplesOf(s)[i].accel, samplesOf(without)[i].accel);
    if (spike.isZero()) continue;
    ASSERT_NEAR(spike.cwiseAbs().sum(), 100, 1e-12);
    ASSERT_NEAR(spike.norm(), 100, 1e-12);  // on one axis
    struck.push_back(samplesOf(s)[i].t);
  }
  EXPECT_EQ(struck, s.faults.front().stamps);
  const double expected = static_cast<double>(samplesOf(s).size()) / 200;
  EXPECT_NEAR(static_cast<double>(struck.size()), expected, 4 * std::sqrt(expected));
}

TEST(ImuFaults, GapLosesItsSamplesAndBurstsKeepTheirLast) {
  const SimulatedSession gap =
      withFaults(soundRecording(), {{.kind = kGap, .value = 0.2, .at_s = 2}});
  EXPECT_EQ(samplesOf(gap).size() + 40, samplesOf(clean()).size());
  EXPECT_EQ(gap.biases.size(), samplesOf(gap).size());
  const SimulatedSession burst = withFaults(soundRecording(), {{.kind = kBurst, .value = 10}});
  ASSERT_EQ(samplesOf(burst).size(), samplesOf(clean()).size());
  for (std::size_t i = 0; i < samplesOf(burst).size(); ++i) {
    const TimeNs t = samplesOf(clean())[i].t;
    const auto number = std::llround(secondsBetween(burst.start_ns, t) * 200);
    const auto before_last = 9 - ((number % 10) + 10) % 10;
    // Read with the last of its ten: 5 ms apart when taken, 20 us when read.
    ASSERT_EQ(samplesOf(burst)[i].t - t, before_last * (5'000'000 - 20'000));
    ASSERT_EQ(samplesOf(burst)[i].gyro, samplesOf(clean())[i].gyro);
  }
}

TEST(ImuFaults, DriftAndStepMoveStampsNotValues) {
  const SimulatedSession s = withFaults(
      soundRecording(),
      {{.kind = kClockDrift, .value = 1e-4}, {.kind = kClockStep, .value = 0.005, .at_s = 2}});
  ASSERT_EQ(samplesOf(s).size(), samplesOf(clean()).size());
  for (std::size_t i = 0; i < samplesOf(s).size(); ++i) {
    const double t_s = secondsBetween(s.start_ns, samplesOf(clean())[i].t);
    const double stamped_s = secondsBetween(s.start_ns, samplesOf(s)[i].t);
    ASSERT_NEAR(stamped_s, t_s * (1 + 1e-4) + (t_s >= 2 ? 0.005 : 0), 1.01e-9);
    ASSERT_EQ(samplesOf(s)[i].accel, samplesOf(clean())[i].accel);
  }
}

TEST(ImuFaults, StampsAscendAfterAStepBack) {
  const SimulatedSession s =
      withFaults(soundRecording(), {{.kind = kClockStep, .value = -0.02, .at_s = 2}});
  const auto& samples = samplesOf(s);
  EXPECT_TRUE(std::is_sorted(samples.begin(), samples.end(),
                             [](const ImuSample& a, const ImuSample& b) { return a.t <= b.t; }));
  EXPECT_EQ(samples.size() + 4, samplesOf(clean()).size());  // 20 ms at 200 Hz, the equal one too
}

}  // namespace
}  // namespace plumbline
