// SPDX-License-Identifier: BSD-3-Clause
// First guesses of the camera-IMU stage from exact poses and samples of an analytic trajectory.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <span>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/initialise/imu_sanity.h"
#include "calibrator/initialise/inertial_alignment.h"
#include "calibrator/initialise/rate_alignment.h"
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

TEST(GyroIntegral, GivesNoMeanAcrossAPause) {
  std::vector<ImuSample> samples;
  for (int k = 0; k <= 60; ++k) samples.push_back({k * 10'000'000, {1, 2, 3}, {0, 0, 0}});
  // From 0 to 60 ms, and from 300 to 350 ms: six times the interval, and five.
  std::erase_if(samples, [](const ImuSample& s) {
    return (s.t > 0 && s.t < 60'000'000) || (s.t > 300'000'000 && s.t < 350'000'000);
  });
  EXPECT_EQ(medianSampleInterval(samples), 0.01);
  const GyroIntegral gyro(samples);
  const auto known = [&](TimeNs from_ms, TimeNs to_ms) {
    return gyro.meanRate(from_ms * 1'000'000, to_ms * 1'000'000, 0).has_value();
  };
  EXPECT_FALSE(known(10, 20));
  EXPECT_FALSE(known(0, 100));
  EXPECT_TRUE(known(60, 100));
  EXPECT_TRUE(known(290, 400));
}

TEST(RateAlignment, SaysAboutWhichAxisTheRigTurned) {
  const Eigen::Vector3d most(0.6, 0, 0.8), little = most.cross(Eigen::Vector3d::UnitY());
  std::vector<RatePair> pairs;
  for (int k = 0; k < 200; ++k) {
    // About a mean that is no turning to and fro.
    const Eigen::Vector3d w = Eigen::Vector3d(1, 2, 3) +
                              2 * std::sin(0.1 * std::numbers::pi * k) * most +
                              0.5 * std::cos(0.1 * std::numbers::pi * k) * little;
    pairs.push_back({w, w});
  }
  const RateAlignment a = alignRates(pairs);
  // RMS of a sine: its amplitude over the root of two.
  EXPECT_LT((a.excitation - Eigen::Vector3d(2, 0.5, 0) / std::sqrt(2)).norm(), 1e-9);
  EXPECT_NEAR(std::abs(a.excitation_axes.col(0).dot(most)), 1, 1e-9);
  EXPECT_NEAR(std::abs(a.excitation_axes.col(1).dot(little)), 1, 1e-9);
}

TEST(TimeOffset, BeyondTheRangeItIsAtTheEdge) {
  const Recording r = exactRecording(0.3);
  const auto rates = cameraRates(r.poses, 0.11);
  TimeOffsetOptions options;
  for (const double range : {0.28, 0.35}) {
    options.max_offset_s = range;
    const auto found = estimateTimeOffset(rates, GyroIntegral(r.samples()), options);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->at_edge, range < 0.3) << range;
  }
}

TEST(TimeOffset, FailuresSayWhatWasThereAndWhatWasNeeded) {
  const Recording r = exactRecording(0);
  auto rates = cameraRates(r.poses, 0.11);
  const GyroIntegral gyro(r.samples());
  const auto few = estimateTimeOffset(std::span(rates).first(19), gyro);
  ASSERT_FALSE(few);
  EXPECT_EQ(toString(few.failure()), "TooFewRates (needed 20, rates 19)");
  const TimeNs begin = rates.front().from;
  for (CameraRate& c : rates) c.from += 100'000'000'000, c.to += 100'000'000'000;
  const auto apart = estimateTimeOffset(rates, gyro);
  ASSERT_FALSE(apart);
  const Failure& f = apart.failure();
  EXPECT_EQ(f.code, FailureCode::kImuDoesNotCover);
  // Times are told from the first frame on.
  const double lead = secondsBetween(r.samples().front().t, begin);
  EXPECT_NEAR(f.number("samples_from_s"), -100 - lead, 1e-6);
  EXPECT_NEAR(f.number("frames_to_s"), secondsBetween(rates.front().from, rates.back().to), 1e-6);
  EXPECT_EQ(f.number("covered"), 0);
  EXPECT_EQ(f.number("intervals"), static_cast<double>(rates.size()));
}

/// The rates of a recording whose camera clock leaves the IMU's by `step_s` in its second half.
std::vector<CameraRate> steppedRates(const Recording& r, double step_s) {
  std::vector<CameraRate> rates = cameraRates(r.poses, 0.11);
  for (std::size_t k = rates.size() / 2; k < rates.size(); ++k) {
    rates[k].from -= toNanoseconds(step_s);
    rates[k].to -= toNanoseconds(step_s);
  }
  return rates;
}

TEST(OffsetsOfParts, AreThoseBeforeAndAfterAStepOfTheClock) {
  const Recording r = exactRecording(0.7, 20);
  const GyroIntegral gyro(r.samples());
  const auto steady = offsetsOfParts(steppedRates(r, 0), gyro, 0.7);
  const auto stepped = offsetsOfParts(steppedRates(r, 0.02), gyro, 0.7);
  ASSERT_TRUE(steady && stepped);
  EXPECT_NEAR(steady->least_s, 0.7, 1e-3);
  EXPECT_NEAR(steady->most_s, 0.7, 1e-3);
  EXPECT_NEAR(stepped->least_s, 0.7, 1e-3);
  EXPECT_NEAR(stepped->most_s, 0.72, 1e-3);
  EXPECT_LT(stepped->std_s, 1e-3);
}

// Short parts of any two motions correlate, each under a rotation of its own.
TEST(OffsetsOfParts, AreThoseUnderOneRotation) {
  const Recording r = exactRecording(0, 20);
  const GyroIntegral gyro(r.samples());
  const auto found = [&](std::size_t same) {  // of ten parts
    std::vector<CameraRate> rates = steppedRates(r, 0);
    for (std::size_t i = 0; i < rates.size(); ++i) {
      const std::size_t part = (10 * i + 9) / rates.size();
      if (part < same) continue;
      rates[i].rate_C = expSO3({0, 0, 0.3 * static_cast<double>(part)}) * rates[i].rate_C;
    }
    return offsetsOfParts(rates, gyro, 0).has_value();
  };
  EXPECT_TRUE(found(10));
  EXPECT_FALSE(found(3));
  const std::vector<CameraRate> whole = steppedRates(r, 0);
  EXPECT_FALSE(offsetsOfParts(std::span(whole).first(29), gyro, 0)) << "not one part";
}

TEST(InertialAlignment, AFewWrongPosesAreLeftOut) {
  const Recording r = exactRecording(0, 20);
  const auto aligned = [&](const std::vector<CameraPose>& poses) {
    return alignInertially(poses, r.samples(), r.truth().T_SC0.R, r.simulated.biases.front().gyro,
                           0)
        .value();
  };
  std::vector<CameraPose> poses = r.poses;
  const InertialAlignment clean = aligned(poses);
  for (const std::size_t k : {50U, 150U, 250U}) poses[k].T_FC0.t.x() += 0.2;
  const InertialAlignment spoilt = aligned(poses);
  // Each is the first, the middle and the last of a triple.
  EXPECT_LT(spoilt.equations, clean.equations);
  EXPECT_GE(spoilt.equations, clean.equations - 9);
  EXPECT_NEAR(spoilt.scale, 1, 2e-3);
  EXPECT_LT((spoilt.t_SC0 - r.truth().T_SC0.t).norm(), 3e-3);
}

// What the sensor did meanwhile is not known: readings beside a pause say nothing of it. With noise
// in the poses the triples across it would not stand out.
TEST(InertialAlignment, NoTripleSpansAPauseOfTheSamples) {
  const Recording r = exactRecording(0, 20);
  std::vector<CameraPose> poses = r.poses;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0, 0.02);
  for (CameraPose& p : poses) {
    p.T_FC0.t += Eigen::Vector3d(normal(random), normal(random), normal(random));
  }
  std::vector<ImuSample> samples = r.samples();
  const auto equations = [&] {
    return alignInertially(poses, samples, r.truth().T_SC0.R, r.simulated.biases.front().gyro, 0)
        .value()
        .equations;
  };
  const int all = equations();
  for (const TimeNs second : {4, 8, 12}) {
    const TimeNs from = r.poses.front().t + second * 1'000'000'000;
    std::erase_if(samples,
                  [&](const ImuSample& s) { return s.t > from && s.t < from + 100'000'000; });
  }
  // Triples span 0.4 s: some ten of 20 Hz reach into each pause, of which three in four are taken.
  EXPECT_LE(equations(), all - 15);
  EXPECT_GE(equations(), all - 36);
}

// Held at the stated size, the accelerometer's readings contradict the camera.
TEST(InertialAlignment, TheStatedSizeLeavesMoreThanTheTrueOne) {
  const Recording r = exactRecording(0, 20);
  auto poses = r.poses;
  const auto aligned = [&] {
    return alignInertially(poses, r.samples(), r.truth().T_SC0.R, r.simulated.biases.front().gyro,
                           0)
        .value();
  };
  const InertialAlignment right = aligned();
  EXPECT_LT(right.fixed_rms, 1.5 * right.residual_rms);
  EXPECT_EQ(right.noise_rms, 0) << "the poses' noise is not known";
  for (CameraPose& p : poses) p.T_FC0.t *= 2;
  EXPECT_GT(aligned().fixed_rms, 10 * aligned().residual_rms);
}

/// A camera that turns in place, on a tripod or in the hand, with the sensor beside it; poses and
/// samples with noise.
struct TurningInPlace {
  std::vector<CameraPose> poses;
  std::vector<ImuSample> samples;
  Eigen::Vector3d t_SC0{0.1, -0.03, 0.05};
  Eigen::Vector3d gravity_F{0, -9.81, 0};

  /// `shared_s2`: position error per error of the force that attitudes turn; of a view of the board
  /// the two are not independent.
  TurningInPlace(double rate_rad_s, std::uint64_t seed, double shared_s2) {
    constexpr double kPosition = 3e-4, kAttitude = 5e-4, kGyro = 2.4e-3, kAccel = 0.028,
                     kStep = 1e-3;
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const auto noise = [&](double std) {
      return Eigen::Vector3d(std * normal(random), std * normal(random), std * normal(random));
    };
    const auto R = [&](double t) {
      const double a = rate_rad_s * t;
      return expSO3({0.3 * std::sin(a), 0.25 * std::sin(1.3 * a + 1), 0.3 * std::sin(0.7 * a + 2)});
    };
    const Eigen::Vector3d centre(0.3, 0.3, 1);
    // Per axis: an attitude turns the force on two of three.
    const double shared = std::sqrt(2.0 / 3) * shared_s2 * gravity_F.norm() * kAttitude;
    for (int k = -200; k < 6200; ++k) {
      const double t = 0.005 * k;
      // Of p_S = centre - R t_SC0, by differences.
      const Eigen::Matrix3d turns = R(t + kStep) - 2 * R(t) + R(t - kStep);
      const Eigen::Vector3d a_F = -turns * t_SC0 / (kStep * kStep);
      samples.push_back(
          {TimeNs{5'000'000} * k,
           logSO3(R(t - kStep).transpose() * R(t + kStep)) / (2 * kStep) + noise(kGyro),
           R(t).transpose() * (a_F - gravity_F) + noise(kAccel)});
    }
    for (int k = 0; k < 600; ++k) {
      const Eigen::Matrix3d error = expSO3(noise(kAttitude));
      const Eigen::Vector3d force_error = gravity_F - error * gravity_F;
      poses.push_back({TimeNs{50'000'000} * k,
                       {Eigen::Matrix3d(error * R(0.05 * k)),
                        Eigen::Vector3d(centre + shared_s2 * force_error + noise(kPosition))},
                       kPosition * kPosition + shared * shared,
                       kAttitude * kAttitude});
    }
  }
};

TEST(InertialAlignment, ACameraThatTurnsInPlaceTellsNoScale) {
  for (const double rate_rad_s : {0.15, 0.5, 1.0, 2.0}) {
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
      const double shared_s2 = seed > 2 ? 0.1 : 0;
      const TurningInPlace r(rate_rad_s, seed, shared_s2);
      const auto a = alignInertially(r.poses, r.samples, Eigen::Matrix3d::Identity(), {0, 0, 0}, 0);
      ASSERT_TRUE(a);
      EXPECT_NEAR(a->scale, 1, 1e-5);
      EXPECT_GT(a->scale_std, 0.25);
      // Nothing is wrong with this accelerometer: neither its axes nor its sign.
      EXPECT_FALSE(checkInertial(*a, AprilGrid())) << rate_rad_s << ", seed " << seed;
      EXPECT_LT((a->t_SC0 - r.t_SC0).norm(), 0.25) << rate_rad_s << ", seed " << seed;
      if (shared_s2 != 0) continue;
      EXPECT_NEAR(residualRatio(*a), 1, 0.15);
      EXPECT_LT((a->gravity_F - r.gravity_F).norm(), 0.1);
    }
  }
}

}  // namespace
}  // namespace plumbline
