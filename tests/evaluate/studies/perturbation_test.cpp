// SPDX-License-Identifier: BSD-3-Clause
// What each perturbation does to the inputs of a calibration, and which amounts are refused.
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/simulate/simulate_session.h"
#include "evaluate/studies/perturbation_study.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;
using Kind = PerturbationKind;

const SimulatedSession& simulatedBriefly() {
  static const SimulatedSession s = [] {
    SimulationOptions options;
    options.duration_s = 4;
    return simulateSession(simulatedRig("euroc"), options);
  }();
  return s;
}

StudyInputs inputs() {
  StudyInputs in;
  in.session = &simulatedBriefly().session;
  in.cameras = simulatedBriefly().truth.cameras;
  return in;
}

std::size_t cornerCount(const Session& session) {
  std::size_t count = 0;
  for (const auto& camera : session.cameras) {
    for (const auto& view : camera.views) count += view.corners.size();
  }
  return count;
}

TEST(Perturbation, ShiftsAreAddedInWholeNanoseconds) {
  const auto p = perturbed(inputs(), {Kind::kImuShift, -3.21});
  EXPECT_EQ(p.camera_imu.imu_shift_ns, -3'210'000);
  EXPECT_FALSE(p.session);  // nothing is copied
  EXPECT_FALSE(p.calibrate_cameras);
}

TEST(Perturbation, TheTargetGrowsAndItsProportionsStay) {
  const auto p = perturbed(inputs(), {Kind::kTargetSize, 2});
  EXPECT_DOUBLE_EQ(p.session->target.tag_size, 1.02 * simulatedBriefly().session.target.tag_size);
  EXPECT_EQ(p.session->target.spacing, simulatedBriefly().session.target.spacing);
  EXPECT_TRUE(p.calibrate_cameras);
}

TEST(Perturbation, AllFourDensitiesAreScaled) {
  const ImuNoise before = simulatedBriefly().session.imu->noise;
  const ImuNoise after = *perturbed(inputs(), {Kind::kNoiseDensities, 3}).camera_imu.noise;
  EXPECT_DOUBLE_EQ(after.gyro_density, 3 * before.gyro_density);
  EXPECT_DOUBLE_EQ(after.gyro_random_walk, 3 * before.gyro_random_walk);
  EXPECT_DOUBLE_EQ(after.accel_density, 3 * before.accel_density);
  EXPECT_DOUBLE_EQ(after.accel_random_walk, 3 * before.accel_random_walk);
  EXPECT_EQ(after.rate_hz, before.rate_hz);
}

TEST(Perturbation, OnlyFocalLengthsStartElsewhere) {
  const auto p = perturbed(inputs(), {Kind::kInitialIntrinsics, -10});
  for (std::size_t c = 0; c < 2; ++c) {
    Eigen::VectorXd expected = simulatedBriefly().truth.cameras[c].intrinsics.projection;
    expected.head<2>() *= 0.9;
    EXPECT_TRUE(p.camera.start[c].intrinsics.projection.isApprox(expected));
  }
}

TEST(Perturbation, AboutTheStatedShareOfFramesIsLeftOut) {
  const auto p = perturbed(inputs(), {Kind::kDroppedFrames, 40, 7});
  const auto before = simulatedBriefly().session.cameras[0].views.size();
  const auto after = p.session->cameras[0].views.size();
  EXPECT_NEAR(static_cast<double>(after), 0.6 * before, 4 * std::sqrt(0.24 * before));
  // Both cameras lose the same frames.
  ASSERT_EQ(p.session->cameras[1].views.size(), after);
  for (std::size_t v = 0; v < after; ++v) {
    EXPECT_EQ(p.session->cameras[0].views[v].t, p.session->cameras[1].views[v].t);
  }
}

TEST(Perturbation, AboutTheStatedShareOfImuSamplesIsLeftOut) {
  const auto p = perturbed(inputs(), {Kind::kDroppedImu, 25, 7});
  const auto before = static_cast<double>(simulatedBriefly().session.imu->samples.size());
  const auto after = static_cast<double>(p.session->imu->samples.size());
  EXPECT_NEAR(after, 0.75 * before, 4 * std::sqrt(0.1875 * before));
}

TEST(Perturbation, CornerNoiseHasTheStatedDeviationAndNoMean) {
  const auto p = perturbed(inputs(), {Kind::kCornerNoise, 0.5, 7});
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double squares = 0;
  for (std::size_t c = 0; c < 2; ++c) {
    const auto& before = simulatedBriefly().session.cameras[c].views;
    const auto& after = p.session->cameras[c].views;
    for (std::size_t v = 0; v < before.size(); ++v) {
      for (std::size_t k = 0; k < before[v].corners.size(); ++k) {
        const Eigen::Vector2d d = after[v].corners[k].uv - before[v].corners[k].uv;
        sum += d;
        squares += d.squaredNorm();
      }
    }
  }
  const auto n = static_cast<double>(cornerCount(simulatedBriefly().session));
  EXPECT_LT((sum / n).cwiseAbs().maxCoeff(), 4 * 0.5 / std::sqrt(n));
  EXPECT_NEAR(squares / (2 * n), 0.25,
              4 * 0.25 / std::sqrt(n));  // std of a variance: s^2 sqrt(2/2n)
}

TEST(Perturbation, ASeedDrawsTheSameAndAnotherDrawsElse) {
  const auto corner = [](std::uint64_t seed) {
    const auto p = perturbed(inputs(), {Kind::kCornerNoise, 0.5, seed});
    return p.session->cameras[0].views[3].corners[0].uv;
  };
  EXPECT_EQ(corner(1), corner(1));
  EXPECT_NE(corner(1), corner(2));
}

TEST(Perturbation, GivenCamerasAreNeverCalibratedAgain) {
  StudyInputs fixed = inputs();
  fixed.cameras_fixed = true;
  EXPECT_FALSE(perturbed(fixed, {Kind::kCornerNoise, 0.5, 1}).calibrate_cameras);
  EXPECT_TRUE(perturbed(inputs(), {Kind::kCornerNoise, 0.5, 1}).calibrate_cameras);
}

TEST(Perturbation, AmountsOutOfRangeAreRefusedByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [p, words] : std::initializer_list<std::pair<Perturbation, const char*>>{
           {{Kind::kTargetSize, -100}, "target-size -100 %: expected above -100"},
           {{Kind::kNoiseDensities, 0}, "noise-densities 0 x: expected above 0"},
           {{Kind::kDroppedFrames, 100}, "dropped-frames 100 %: expected from 0 to below 100"},
           {{Kind::kDroppedImu, -1}, "dropped-imu -1 %"},
           {{Kind::kCornerNoise, -0.1}, "corner-noise -0.1 px"},
           {{Kind::kImuShift, nan}, "imu-shift nan ms: expected a number"}}) {
    try {
      (void)perturbed(inputs(), p);
      ADD_FAILURE() << words;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(words));
    }
  }
}

}  // namespace
}  // namespace plumbline
