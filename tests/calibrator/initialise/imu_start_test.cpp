// SPDX-License-Identifier: BSD-3-Clause
// First guesses of the camera-IMU stage from exact poses and samples of an analytic trajectory.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/initialise/imu_alignment.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

struct Recording {
  SimulatedSession simulated;
  std::vector<CameraPose> poses;

  const std::vector<ImuSample>& samples() const { return simulated.session.imu->samples; }
  const ImuCalibration& truth() const { return *simulated.truth.imu; }
};

Recording exactRecording(double time_offset_s, double duration_s = 10) {
  SimulationOptions options;
  options.duration_s = duration_s;
  options.imu_noise = false;
  options.time_offset_s = time_offset_s;
  options.imu_margin_s = 1.5;
  Recording r{simulateSession(simulatedRig("euroc"), options), {}};
  for (const TimeNs t : r.simulated.frame_stamps) {
    r.poses.push_back({t, r.simulated.cameraPose(0, t)});
  }
  return r;
}

TEST(CameraRates, OfAConstantRateAreThatRate) {
  const Eigen::Vector3d w(0.3, -0.5, 0.8);
  std::vector<CameraPose> poses;
  for (int k = 0; k < 4; ++k) {
    const double t = 0.05 * k + (k == 3 ? 1.0 : 0.0);  // the last one is far off
    poses.push_back({toNanoseconds(t), {expSO3(w * t), Eigen::Vector3d::Zero()}});
  }
  const auto rates = cameraRates(poses, 0.1);
  ASSERT_EQ(rates.size(), 2u);
  EXPECT_LT((rates[1].rate_C - w).norm(), 1e-12);
}

TEST(GyroIntegral, GivesTheMeanOfALinearRateOverAnyWindow) {
  std::vector<ImuSample> samples;
  for (int k = 0; k <= 100; ++k) samples.push_back({k * 10'000'000, {0.01 * k, 0, 1}, {0, 0, 0}});
  const GyroIntegral gyro(samples);
  const auto mean = gyro.meanRate(100'000'000, 137'000'000, 0.2);  // [0.3, 0.337] s
  ASSERT_TRUE(mean);
  EXPECT_NEAR(mean->x(), 0.3185, 1e-12);
  EXPECT_NEAR(mean->z(), 1, 1e-12);
  EXPECT_FALSE(gyro.meanRate(100'000'000, 137'000'000, 0.9));
  EXPECT_FALSE(gyro.meanRate(100'000'000, 137'000'000, -0.2));
}

TEST(RateAlignment, FindsRotationBiasAndUnits) {
  const Eigen::Matrix3d R_SC0 = expSO3({0.5, -1.2, 0.9});
  const Eigen::Vector3d bias(0.01, -0.02, 0.03);
  std::vector<RatePair> pairs;
  for (int k = 0; k < 50; ++k) {
    const Eigen::Vector3d w(std::sin(0.3 * k), std::cos(0.5 * k), 0.5 * std::sin(0.7 * k));
    pairs.push_back({R_SC0 * w + bias, w});
  }
  const RateAlignment a = alignRates(pairs);
  EXPECT_LT(rotationAngle(a.R_SC0.transpose() * R_SC0), 1e-12);
  EXPECT_LT((a.gyro_bias - bias).norm(), 1e-12);
  EXPECT_NEAR(a.correlation, 1, 1e-12);
  EXPECT_NEAR(a.gyro_to_camera, 1, 1e-12);
  EXPECT_LT(a.mirrored_correlation, 0.95);
  for (RatePair& p : pairs) p.gyro_S = -57.3 * p.gyro_S;  // a reflection, in degrees
  const RateAlignment mirrored = alignRates(pairs);
  EXPECT_NEAR(mirrored.mirrored_correlation, 1, 1e-12);
  EXPECT_NEAR(mirrored.gyro_to_camera, 57.3, 1e-9);
  EXPECT_GT(mirrored.R_SC0.determinant(), 0);
}

TEST(RateAlignment, OfNothingIsNothing) {
  EXPECT_EQ(alignRates({}).correlation, 0);
  const std::vector<RatePair> still(10);
  EXPECT_EQ(alignRates(still).correlation, 0);
}

TEST(TimeOffset, IsFoundOverTheWholeRange) {
  for (const double offset : {0.0, 0.0373, -0.25, 0.5, 0.99, -1.0}) {
    const Recording r = exactRecording(offset);
    const auto rates = cameraRates(r.poses, 0.11);
    const auto found = estimateTimeOffset(rates, GyroIntegral(r.samples()));
    ASSERT_TRUE(found) << found.failure();
    EXPECT_NEAR(found->offset_s, offset, 1e-3);  // a fiftieth of a frame interval
    EXPECT_LT(rotationAngle(found->alignment.R_SC0.transpose() * r.truth().T_SC0.R), 0.02);
    EXPECT_GT(found->alignment.correlation, 0.999);
  }
}

TEST(TimeOffset, FailsWithoutOverlap) {
  const Recording r = exactRecording(0);
  auto rates = cameraRates(r.poses, 0.11);
  for (CameraRate& c : rates) {
    c.from += 100'000'000'000;
    c.to += 100'000'000'000;
  }
  const auto found = estimateTimeOffset(rates, GyroIntegral(r.samples()));
  ASSERT_FALSE(found);
  EXPECT_EQ(found.failure().reason(), FailureReason::kNoOverlap);
}

TEST(InertialAlignment, FindsScaleGravityTranslationAndBias) {
  Recording r = exactRecording(0.002, 20);
  const ImuBias bias = r.simulated.biases.front();
  for (const double scale : {1.0, 0.5}) {
    auto poses = r.poses;
    for (CameraPose& p : poses) p.T_FC0.t /= scale;  // a target stated 1 / scale times too large
    const auto a = alignInertially(poses, r.samples(), r.truth().T_SC0.R, bias.gyro, 0.002);
    ASSERT_TRUE(a);
    EXPECT_NEAR(a->scale, scale, 2e-3 * scale);
    EXPECT_LT((a->gravity_F - r.simulated.gravity_F).norm(), 0.02);
    EXPECT_LT((a->t_SC0 - r.truth().T_SC0.t).norm(), 3e-3);
    EXPECT_LT((a->accel_bias - bias.accel).norm(), 0.02);
    EXPECT_LT(a->residual_rms, 0.02);
  }
}

// Attitudes turn gravity, and with a long lever arm the way from camera to sensor.
TEST(InertialAlignment, NoiseOfAttitudesIsWhatTheResidualsShow) {
  constexpr double kAttitude_rad = 0.01;
  const Recording exact = exactRecording(0, 20);
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(0, kAttitude_rad);
  for (const Eigen::Vector3d& further : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.3, 0, -0.2)}) {
    double noise = 0, residual = 0;
    for (int draw = 0; draw < 5; ++draw) {
      auto poses = exact.poses;
      for (CameraPose& p : poses) {
        p.T_FC0.t += p.T_FC0.R * further;  // the camera is elsewhere on the rig
        p.T_FC0.R = expSO3({normal(random), normal(random), normal(random)}) * p.T_FC0.R;
        p.rotation_variance = kAttitude_rad * kAttitude_rad;
        p.position_variance = 1e-16;
      }
      const auto a = alignInertially(poses, exact.samples(), exact.truth().T_SC0.R,
                                     exact.simulated.biases.front().gyro, 0);
      ASSERT_TRUE(a);
      noise += a->noise_rms * a->noise_rms;
      residual += std::pow(a->residual_rms / a->scale, 2);
    }
    EXPECT_NEAR(std::sqrt(noise / residual), 1, 0.1) << further.transpose();
  }
}

TEST(InertialAlignment, IsEmptyForTooFewFrames) {
  Recording r = exactRecording(0);
  r.poses.resize(8);
  EXPECT_FALSE(alignInertially(r.poses, r.samples(), r.truth().T_SC0.R, {0, 0, 0}, 0));
}

}  // namespace
}  // namespace plumbline
