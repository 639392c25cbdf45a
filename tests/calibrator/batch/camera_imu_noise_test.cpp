// SPDX-License-Identifier: BSD-3-Clause
// What the inertial residuals say of the assumed densities, on simulated recordings whose noise is
// known: bounds of chi-square where the assumptions hold, densities that are wrong by 3, and a
// pixel sigma that is wrong by 5.
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/batch/camera_imu/stage.h"
#include "calibrator/simulate/faults/fault.h"
#include "tests/calibrator/batch/camera_imu_examples.h"

namespace plumbline {
namespace {

struct Assumed {
  double gyro = 1;  // of the density that was simulated
  double accel = 1;
  double pixel_sigma = 0.2;  // as simulated
};

/// Shared: assumptions differ, recordings do not.
const SimulatedSession& recorded(std::uint64_t seed, double duration_s) {
  static std::map<std::pair<std::uint64_t, double>, SimulatedSession> all;
  const auto known = all.find({seed, duration_s});
  if (known != all.end()) return known->second;
  SimulationOptions simulation = test::noisyRecording(seed, duration_s);
  simulation.trajectory.seed = seed;
  return all.emplace(std::pair(seed, duration_s), test::simulate(simulation)).first->second;
}

ImuResidualSummary summaryUnder(const Assumed& assumed, std::uint64_t seed,
                                double duration_s = 10) {
  const SimulatedSession& s = recorded(seed, duration_s);
  CameraImuOptions options = test::matchedOptions(s, assumed.pixel_sigma);
  options.noise_check = true;
  options.diagnose_faults = false;
  options.noise = s.session.imu->noise;
  options.noise->gyro_density *= assumed.gyro;
  options.noise->accel_density *= assumed.accel;
  const auto result = calibrateCameraImu(s.session, s.truth.cameras, options);
  if (!result) throw std::runtime_error(toString(result.failure()));
  return result->imu_summary;
}

/// Sum over seeds of |r|^2 against sum of redundancy: chi-square with that many degrees.
void expectChiSquare(double squares, double redundancy) {
  EXPECT_NEAR(squares, redundancy, 4 * std::sqrt(2 * redundancy));
}

TEST(ImuNoiseCheck, SquaresAreAsExpectedWhereTheAssumptionsHold) {
  double gyro = 0, accel = 0, gyro_redundancy = 0, accel_redundancy = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const ImuResidualSummary s = summaryUnder({}, seed);
    const double rows = 3.0 * s.dof / 15;
    gyro += rows * std::pow(s.gyro_normalised_rms, 2);
    gyro_redundancy += rows * std::pow(s.noise.gyro.expected_rms, 2);
    accel += 2 * rows * std::pow(s.accel_normalised_rms, 2);
    accel_redundancy += 2 * rows * std::pow(s.noise.accel.expected_rms, 2);
    // A factor's relative deviation is 1 / sqrt(2 redundancy), and more for its neighbours' sake.
    EXPECT_NEAR(std::log(s.noise.gyro.factor), 0, 5 / std::sqrt(2 * s.noise.gyro.redundancy));
    EXPECT_NEAR(std::log(s.noise.accel.factor), 0, 5 / std::sqrt(2 * s.noise.accel.redundancy));
    EXPECT_NEAR(s.noise.pose_pixel_sigma, 0.2, 0.015);
    EXPECT_LT(s.noise.gyro.expected_rms, 0.7);  // far from 1, which is why it is reported
  }
  expectChiSquare(gyro, gyro_redundancy);
  expectChiSquare(accel, accel_redundancy);
}

TEST(ImuNoiseCheck, DensitiesWrongByThreeShowAsAThirdAndThree) {
  const ImuNoiseChecks right = summaryUnder({}, 2).noise;
  for (const double wrong : {3.0, 1 / 3.0}) {
    const ImuNoiseChecks both = summaryUnder({wrong, wrong, 0.2}, 2).noise;
    EXPECT_NEAR(both.gyro.factor * wrong, right.gyro.factor, 0.1);
    EXPECT_NEAR(both.accel.factor * wrong, right.accel.factor, 0.1);
    const ImuNoiseChecks gyro = summaryUnder({wrong, 1, 0.2}, 2).noise;
    EXPECT_NEAR(gyro.gyro.factor * wrong, right.gyro.factor, 0.1);
    EXPECT_NEAR(gyro.accel.factor, right.accel.factor, 0.1);
    const ImuNoiseChecks accel = summaryUnder({1, wrong, 0.2}, 2).noise;
    EXPECT_NEAR(accel.gyro.factor, right.gyro.factor, 0.1);
    EXPECT_NEAR(accel.accel.factor * wrong, right.accel.factor, 0.1);
  }
}

// Under them an interval has next to no redundancy: states follow the samples, poses pay.
TEST(ImuNoiseCheck, DensitiesFarTooSmallAreToldFromFewFrames) {
  const ImuNoiseChecks noise = summaryUnder({0.25, 0.25, 0.2}, 2, 4).noise;
  EXPECT_LT(noise.gyro.expected_rms, 0.25);
  for (const ImuNoiseCheck& check : {noise.gyro, noise.accel}) {
    EXPECT_NEAR(std::log(check.factor / 4), 0, 4 / std::sqrt(2 * check.redundancy));
    EXPECT_GT(check.factor, 2.5);
  }
  EXPECT_NEAR(noise.pose_pixel_sigma, 0.2, 0.03);
  EXPECT_EQ(noise.gyro_bias.factor, 1);  // of a walk so short nothing is known
}

TEST(ImuNoiseCheck, AWrongPixelSigmaDoesNotMatter) {
  const ImuNoiseChecks right = summaryUnder({}, 3).noise;
  const ImuNoiseChecks wrong = summaryUnder({1, 1, 1}, 3).noise;
  EXPECT_NEAR(wrong.gyro.factor, right.gyro.factor, 0.1);
  EXPECT_NEAR(wrong.accel.factor, right.accel.factor, 0.1);
  EXPECT_NEAR(wrong.pose_pixel_sigma, 0.2, 0.015);
  EXPECT_LT(wrong.gyro.expected_rms, 0.5 * right.gyro.expected_rms);  // but that it does
}

// Their 22 parameters take up errors of the corners, but not of the poses.
TEST(ImuNoiseCheck, FreedCamerasLeaveTheCornersNoiseAsItIs) {
  double fixed = 0, free = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const SimulatedSession s = test::simulate(test::noisyRecording(seed, 1.5));
    CameraImuOptions options = test::matchedOptions(s, 0.2);
    options.noise_check = true;
    options.diagnose_faults = false;
    const auto sigma = [&] {
      const auto result = calibrateCameraImu(s.session, s.truth.cameras, options);
      if (!result) throw std::runtime_error(toString(result.failure()));
      return result->imu_summary.noise.pose_pixel_sigma;
    };
    fixed += sigma() / 3;
    options.free_cameras = true;
    free += sigma() / 3;
  }
  EXPECT_NEAR(free, fixed, 0.01);
}

FrameErrors frameErrorsWith(const std::vector<Fault>& faults) {
  SimulationOptions simulation = test::noisyRecording(3, 12);
  simulation.faults = faults;
  const SimulatedSession s = test::simulate(simulation);
  CameraImuOptions options = test::matchedOptions(s, 0.2);
  options.noise_check = true;
  options.diagnose_faults = false;
  const auto result = calibrateCameraImu(s.session, s.truth.cameras, options);
  if (!result) throw std::runtime_error(toString(result.failure()));
  return result->frame_errors.value();
}

TEST(FrameErrors, AreTheCornersNoiseWhereFramesAndImuAgree) {
  const FrameErrors e = frameErrorsWith({});
  EXPECT_NEAR(e.free_rmse_px, std::sqrt(2) * 0.2, 0.01);
  EXPECT_LT(e.rmse_px / e.free_rmse_px, 1.05);
  EXPECT_LT(e.along / e.across, 2.5);
}

// What the corners show of a shift of every frame's stamp: more than half of it, under a
// pixel_sigma that leaves the IMU its say, and no other motion of the frames.
TEST(FrameErrors, TellTheJitterOfStamps) {
  for (const double jitter_s : {0.5e-3, 1e-3, 2e-3}) {
    const FrameErrors e = frameErrorsWith({{.kind = FaultKind::kJitter, .value = jitter_s}});
    EXPECT_GT(e.jitter_s, 0.5 * jitter_s);
    EXPECT_LT(e.jitter_s, jitter_s);
    EXPECT_GT(e.along / e.across, 20);
    EXPECT_LT(e.neighbours, 0.2);
  }
}

// That clamp is the solver's.
TEST(FrameErrors, DoNotDependOnHowTheSolverTakesTheLoss) {
  const SimulatedSession s = test::simulate(test::noisyRecording(3, 3));
  CameraImuOptions options = test::matchedOptions(s, 0.2);
  options.cauchy_px = 0.5;
  options.diagnose_faults = false;
  const auto result = calibrateCameraImu(s.session, s.truth.cameras, options);
  ASSERT_TRUE(result);
  SolvedCameraImu solved = solvedBatch(s.session, *result, options);
  const FrameErrors as_solved = frameErrors(solved.problem, solved.estimate);
  solved.problem.gram.triggs_clamp = 0;
  EXPECT_EQ(frameErrors(solved.problem, solved.estimate).across, as_solved.across);
}

// 2.8e-3 rad/s/sqrt(Hz): poses follow such an IMU little, and what they leave of quiet corners'
// noise is no figure (it came out as 0.001 to 0.044 px); of loud ones it is.
TEST(ImuNoiseCheck, QuietCornersBesideANoisyImuAreNotTold) {
  const auto sigmaOfPoses = [](double corner_sigma_px, const std::vector<Fault>& faults) {
    SimulationOptions simulation = test::noisyRecording(3, 10);
    simulation.corner_sigma_px = corner_sigma_px;
    simulation.faults = faults;
    const SimulatedSession s = simulateSession(simulatedRig("d435i"), simulation);
    CameraImuOptions options = test::matchedOptions(s, 1);
    options.noise_check = true;
    options.diagnose_faults = false;
    const auto result = calibrateCameraImu(s.session, s.truth.cameras, options);
    if (!result) throw std::runtime_error(toString(result.failure()));
    EXPECT_GT(result->imu_summary.noise.gyro.redundancy, 100);
    return result->imu_summary.noise.pose_pixel_sigma;
  };
  EXPECT_EQ(sigmaOfPoses(0.01, {}), 0);
  EXPECT_NEAR(sigmaOfPoses(0.2, {}), 0.2, 0.05);
  const Fault jitter{.kind = FaultKind::kJitter, .value = 1e-3};
  EXPECT_GT(sigmaOfPoses(0.01, {jitter}), 0.1) << "squares that are not of chance";
}

}  // namespace
}  // namespace plumbline
