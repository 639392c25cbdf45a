// SPDX-License-Identifier: BSD-3-Clause
// The camera-IMU batch on simulated recordings: what must not change the result. High rates of the
// IMU are in camera_imu_rates_statistics_test, statistics of noisy runs in
// camera_imu_statistics_test.
#include <cstdint>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/batch/camera_imu/stage.h"
#include "calibrator/camera/camera.h"
#include "tests/calibrator/batch/camera_imu_examples.h"

namespace plumbline {
namespace {

using test::calibrationError;
using test::exactRecording;
using test::matchedOptions;
using test::noisyRecording;
using test::simulate;

CameraImuStageResult solved(const SimulatedSession& s, const CameraImuOptions& options) {
  const auto result = calibrateCameraImu(s.session, s.truth.cameras, options);
  if (!result) throw std::runtime_error(toString(result.failure()));
  return *result;
}

TEST(CameraImuWithoutNoise, FreeCamerasReturnToTheTruth) {
  const SimulatedSession s = simulate(exactRecording(3200));
  CameraImuOptions options = matchedOptions(s, 1);
  options.free_cameras = true;
  std::vector<CameraCalibration> start = s.truth.cameras;
  start[0].intrinsics.projection += Eigen::Vector4d(1, -1, 0.5, -0.5);
  start[1].intrinsics.distortion(0) += 1e-3;
  start[1].T_C0Ci.t.x() += 1e-3;
  const auto r = calibrateCameraImu(s.session, start, options);
  ASSERT_TRUE(r) << r.failure();
  for (std::size_t c = 0; c < 2; ++c) {
    const Eigen::VectorXd error =
        r->cameras[c].intrinsics.stacked() - s.truth.cameras[c].intrinsics.stacked();
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 1e-3) << c;
    ASSERT_TRUE(r->cameras[c].intrinsics_std);
  }
  EXPECT_LT(boxminus(r->cameras[1].T_C0Ci, s.truth.cameras[1].T_C0Ci).norm(), 1e-5);
  ASSERT_EQ(r->summary.covariance.names.size(), 7u + 8 + 8 + 6);
  EXPECT_EQ(r->summary.covariance.names[7], "cam0.fu");
  EXPECT_EQ(r->summary.covariance.names[7 + 8], "cam1.fu");
  EXPECT_EQ(r->summary.covariance.names[7 + 8 + 8], "T_C0C1.tx");
  EXPECT_EQ(r->summary.covariance.names.back(), "T_C0C1.rz");
}

TEST(CameraImu, ReportsWhatItUsed) {
  const SimulatedSession s = simulate(noisyRecording(1));
  const CameraImuStageResult r = solved(s, matchedOptions(s, 0.2));
  const StageSummary& summary = r.summary;
  EXPECT_TRUE(summary.converged);
  EXPECT_EQ(r.states.size(), r.frames.size());
  EXPECT_EQ(r.imu_residuals.size(), r.frames.size() - 1);
  EXPECT_EQ(summary.corners_used, r.residuals.size());
  EXPECT_NEAR(summary.reprojection.rmse_px, 0.2 * std::sqrt(2), 0.01);
  EXPECT_EQ(summary.covariance.names.front(), "T_SC0.tx");
  EXPECT_EQ(summary.covariance.names.back(), "time_offset");
  EXPECT_EQ(summary.covariance.matrix.rows(), 7);
  ASSERT_TRUE(r.imu.T_SC0_std && r.imu.time_offset_std_s);
  EXPECT_EQ(*r.imu.time_offset_std_s, std::sqrt(summary.covariance.matrix(6, 6)));
  EXPECT_GT(r.imu_summary.chi2, 0);
  EXPECT_EQ(r.imu_summary.dof, static_cast<int>(15 * r.imu_residuals.size()));
}

// The noise of the poses tells a lever arm of metres, along which the cost is nearly flat.
TEST(CameraImu, ASlowTurnInPlaceConverges) {
  SimulatedRig rig = simulatedRig("euroc");
  rig.calibration.cameras.resize(1);
  for (const std::uint64_t seed : {3, 4, 5}) {
    SimulationOptions simulation = noisyRecording(seed, 30);
    simulation.camera_rate_hz = 10;
    simulation.trajectory = {.seed = seed, .pace = 0.15, .reach = 0};
    const SimulatedSession s = simulateSession(rig, simulation);
    CameraImuOptions options = matchedOptions(s, 0.2);
    options.max_translation_std_m = 0.1;
    options.diagnose_faults = false;
    const CameraImuStageResult r = solved(s, options);
    EXPECT_TRUE(r.summary.converged) << seed;
    EXPECT_LT(r.summary.iterations, 40) << seed;
    const Eigen::VectorXd error = calibrationError(s, r);
    const Eigen::VectorXd deviations = r.summary.covariance.standardDeviations();
    EXPECT_LT(error.cwiseQuotient(deviations).cwiseAbs().maxCoeff(), 4) << seed;
  }
}

// The cost has them (view_gram.h).
TEST(CameraImu, CornersBeyondTheFoldOfALensAreListedAsUsed) {
  const SimulatedSession s = simulate(exactRecording(200, 1));
  CameraImuProblem problem = makeProblem(s.session, matchedOptions(s, 0.2));
  problem.frames = {pairFrames(s.session.cameras, {}).front()};
  CameraImuEstimate estimate;
  estimate.states = {s.stateAt(problem.frames[0].t)};
  estimate.T_SC0 = s.truth.imu->T_SC0;
  estimate.gravity_direction = s.gravity_F.normalized();
  estimate.time_offsets = s.truth.imu->time_offsets;
  estimate.cameras = s.truth.cameras;
  double cost = 0;
  int beyond = 0;
  for (std::size_t c = 0; c < estimate.cameras.size(); ++c) {
    Intrinsics& lens = estimate.cameras[c].intrinsics;
    lens.distortion << -6, 0, 0, 0;
    const Transform T_CF = targetInCamera(problem, estimate, 0, c);
    const PackedView view = problem.corners[c].view(problem.frames[0].view[c]);
    cost += viewCost(lens, T_CF, view);
    for (int k = 0; k < view.count; ++k) {
      beyond += project(lens, T_CF * Eigen::Vector3d(view.x[k], view.y[k], view.z[k])) ? 0 : 1;
    }
  }
  ASSERT_GT(beyond, 0);
  double squares = 0;
  for (const CornerResidual& r : cornerResiduals(problem, estimate)) {
    EXPECT_TRUE(r.used);
    squares += r.error.cast<double>().squaredNorm();
  }
  EXPECT_NEAR(squares, cost, 1e-5 * cost);
}

// What was read differs from the truth by its stated deviation, and from the prediction by the
// residual; of rotations that to first order in the angle turned (a tenth of a radian here).
TEST(CameraImu, ReadingsSpreadAboutTheTruthByTheirDeviation) {
  const SimulatedSession s = simulate(noisyRecording(3, 20));
  CameraImuOptions options = matchedOptions(s, 0.2);
  options.diagnose_faults = false;
  const CameraImuStageResult r = solved(s, options);
  double gyro = 0, accel = 0;
  for (const ImuIntervalResidual& interval : r.imu_residuals) {
    const TimeNs end = interval.t + toNanoseconds(interval.dt_s);
    const ImuState i = s.stateAt(interval.t), j = s.stateAt(end);
    const Eigen::Matrix3d R_SF = i.T_FS.R.transpose();
    const Eigen::Vector3d rate = logSO3(R_SF * j.T_FS.R) / interval.dt_s + i.gyro_bias;
    const Eigen::Vector3d force =
        R_SF * ((j.v_F - i.v_F) / interval.dt_s - s.gravity_F) + i.accel_bias;
    gyro += (interval.gyro.measured - rate).cwiseQuotient(interval.gyro.std).squaredNorm();
    accel += (interval.accel.measured - force).cwiseQuotient(interval.accel.std).squaredNorm();
    EXPECT_LT(
        (interval.gyro.predicted - interval.gyro.measured - interval.rotation_rad / interval.dt_s)
            .norm(),
        0.1 * (interval.rotation_rad / interval.dt_s).norm() + 1e-9);
    EXPECT_LT(
        (interval.accel.predicted - interval.accel.measured - interval.velocity_m_s / interval.dt_s)
            .norm(),
        1e-9);
  }
  const double n = 3 * static_cast<double>(r.imu_residuals.size());
  EXPECT_NEAR(gyro / n, 1, 5 * std::sqrt(2 / n));  // five deviations of a mean of squares
  EXPECT_NEAR(accel / n, 1, 5 * std::sqrt(2 / n));
}

TEST(CameraImu, DoesNotDependOnTheNumberOfThreads) {
  const SimulatedSession s = simulate(noisyRecording(2, 8));
  CameraImuOptions options = matchedOptions(s, 0.2);
  options.cauchy_px = 1;
  const CameraImuStageResult one = solved(s, options);
  options.threads = 3;
  const CameraImuStageResult three = solved(s, options);
  EXPECT_EQ(one.imu.T_SC0.matrix(), three.imu.T_SC0.matrix());
  EXPECT_EQ(one.imu.timeOffset(), three.imu.timeOffset());
  EXPECT_EQ(one.summary.covariance.matrix, three.summary.covariance.matrix);
  EXPECT_EQ(one.summary.cost, three.summary.cost);
}

/// Camera 1's stamps moved by `shift`; its exposures stay where they were.
SimulatedSession withShiftedCamera1(SimulatedSession s, TimeNs shift) {
  for (ImageView& view : s.session.cameras[1].views) view.t += shift;
  return s;
}

TEST(CameraImu, AConstantShiftOfACamerasStampsIsItsOwnOffset) {
  SimulatedSession s = simulate(noisyRecording(4, 10));
  // Covariances go by the cameras' names, which need not be those of their places.
  s.session.cameras[1].name = s.truth.cameras[1].name = "cam2";
  CameraImuOptions options = matchedOptions(s, 0.2);
  options.diagnose_faults = false;
  const CameraImuStageResult base = solved(s, options);
  EXPECT_FALSE(haveOwnOffsets(base.imu.time_offsets));
  for (const TimeNs shift : {3'000'000, -1'000'000}) {
    const CameraImuStageResult moved = solved(withShiftedCamera1(s, shift), options);
    EXPECT_TRUE(moved.summary.converged);
    ASSERT_EQ(moved.frames.size(), base.frames.size());
    EXPECT_TRUE(hasOwnOffset(moved.imu.time_offsets, 1));
    // One more parameter: camera 1's own offset, known to some microseconds.
    const double own = moved.imu.timeOffset(1) + static_cast<double>(shift) * 1e-9;
    EXPECT_NEAR(own, s.truth.imu->timeOffset(), 100e-6) << shift;
    const ParameterCovariance& covariance = moved.summary.covariance;
    ASSERT_EQ(covariance.names.back(), "time_offset.cam2");
    const double own_std = covariance.standardDeviations()(7);
    EXPECT_LT(std::abs(own - s.truth.imu->timeOffset()), 4 * own_std) << shift;
    EXPECT_LT(own_std, 100e-6) << shift;
    EXPECT_NEAR(moved.imu.timeOffset(), base.imu.timeOffset(), *base.imu.time_offset_std_s);
    const Vector6d change = boxminus(moved.imu.T_SC0, base.imu.T_SC0);
    EXPECT_LT(change.cwiseQuotient(*base.imu.T_SC0_std).cwiseAbs().maxCoeff(), 1) << shift;
    EXPECT_NEAR(moved.summary.reprojection.rmse_px, base.summary.reprojection.rmse_px, 1e-3);
  }
}

/// Camera 1 exposed `delay` later than camera 0, and stamped so.
SimulatedSession withLateCamera1(const SimulationOptions& options, TimeNs delay) {
  SimulatedSession s = simulate(options);
  SimulationOptions later = options;
  later.time_offset_s = s.truth.imu->timeOffset() + secondsBetween(0, delay);
  s.session.cameras[1].views = simulate(later).session.cameras[1].views;
  return withShiftedCamera1(std::move(s), delay);
}

TEST(CameraImu, ACameraThatIsExposedLaterIsTakenAtItsOwnStamps) {
  const SimulationOptions simulation = exactRecording(1600);
  for (const TimeNs delay : {3'000'000, 1'000'000}) {
    const SimulatedSession s = withLateCamera1(simulation, delay);
    CameraImuOptions options = matchedOptions(s, 1);
    options.diagnose_faults = false;
    const CameraImuStageResult r = solved(s, options);
    EXPECT_TRUE(r.summary.converged);
    EXPECT_LT(r.summary.reprojection.rmse_px, 0.01) << delay;
    EXPECT_TRUE(hasOwnOffset(r.imu.time_offsets, 1));
    EXPECT_NEAR(r.imu.timeOffset(0), s.truth.imu->timeOffset(), 10e-6);
    EXPECT_NEAR(r.imu.timeOffset(1), s.truth.imu->timeOffset(), 10e-6);
    EXPECT_LT(boxminus(r.imu.T_SC0, s.truth.imu->T_SC0).norm(), 2e-4) << delay;
  }
}

TEST(CameraImu, ShiftedImuStampsShiftTheOffsetAndNothingElse) {
  const SimulatedSession s = simulate(noisyRecording(3, 8));
  CameraImuOptions options = matchedOptions(s, 0.2);
  options.tolerance = 1e-6;
  options.diagnose_faults = false;
  const CameraImuStageResult base = solved(s, options);
  for (const double shift_ms : {-3.21, 1000.0, -1000.0}) {
    options.imu_shift_ns = toNanoseconds(shift_ms * 1e-3);
    options.offset_search.max_offset_s = 1.1;
    const CameraImuStageResult moved = solved(s, options);
    ASSERT_EQ(moved.frames.size(), base.frames.size()) << shift_ms;
    EXPECT_NEAR(moved.imu.timeOffset() - base.imu.timeOffset(), shift_ms * 1e-3, 1e-8);
    const Vector6d change = boxminus(moved.imu.T_SC0, base.imu.T_SC0);
    EXPECT_LT(change.cwiseQuotient(*base.imu.T_SC0_std).cwiseAbs().maxCoeff(), 1e-3) << shift_ms;
  }
}

TEST(CameraImu, GapsBreakTheChainAndAreCounted) {
  SimulatedSession s = simulate(noisyRecording(4, 10));
  auto& samples = s.session.imu->samples;
  const TimeNs gap = samples[samples.size() / 2].t;
  std::erase_if(samples, [&](const ImuSample& x) {
    return x.t > gap && x.t < gap + 300'000'000;  // six frames
  });
  const CameraImuStageResult r = solved(s, matchedOptions(s, 0.2));
  EXPECT_EQ(r.imu_gaps, 1);
  EXPECT_GE(r.frames_without_imu, 5);
  EXPECT_EQ(r.imu_residuals.size(), r.frames.size() - 2);
  const auto e = calibrationError(s, r);
  EXPECT_LT((e.head<6>().cwiseQuotient(*r.imu.T_SC0_std)).cwiseAbs().maxCoeff(), 4);
}

TEST(CameraImu, FramesOutsideTheImuRecordingAreLeftOut) {
  SimulatedSession s = simulate(noisyRecording(5, 8));
  auto& samples = s.session.imu->samples;
  samples.erase(samples.begin(), samples.begin() + 400);  // 0.5 s of margin and 1.5 s of frames
  const CameraImuStageResult r = solved(s, matchedOptions(s, 0.2));
  EXPECT_NEAR(r.frames_without_imu, 30, 2);
}

TEST(CameraImu, OutliersAreRejectedAndCounted) {
  SimulationOptions simulation = noisyRecording(6);
  simulation.outlier_fraction = 0.01;
  const SimulatedSession s = simulate(simulation);
  CameraImuOptions options = matchedOptions(s, 0.2);
  for (const CornerFilter filter : {CornerFilter::kSigma, CornerFilter::kKalibr}) {
    options.filter = filter;
    options.cauchy_px = 1;
    const CameraImuStageResult r = solved(s, options);
    const double rejected =
        1 - static_cast<double>(r.summary.corners_used) / static_cast<double>(r.residuals.size());
    EXPECT_GT(rejected, 0.005);
    EXPECT_LT(rejected, 0.08);
    EXPECT_LT(r.summary.reprojection.rmse_px, 0.5);
  }
}

TEST(CameraImu, OnlyListedFramesAreUsed) {
  const SimulatedSession s = simulate(noisyRecording(7));
  CameraImuOptions options = matchedOptions(s, 0.2);
  const CameraImuStageResult all = solved(s, options);
  std::vector<TimeNs> stamps;
  for (std::size_t i = 10; i < 70; ++i) stamps.push_back(all.frames[i].t);
  options.frame_stamps = stamps;
  const CameraImuStageResult some = solved(s, options);
  EXPECT_EQ(some.frames.size(), 60u);
  EXPECT_EQ(some.frames.front().t, stamps.front());
}

TEST(CameraImuAgain, WholeRecordingGivesTheSameSolution) {
  const SimulatedSession s = simulate(noisyRecording(8, 8));
  CameraImuOptions options = matchedOptions(s, 0.2);
  options.tolerance = 1e-7;
  const CameraImuStageResult base = solved(s, options);
  const int n = static_cast<int>(base.frames.size());
  const auto again = recalibrateCameraImu(s.session, base, {{0, n, 1}}, options);
  ASSERT_TRUE(again) << again.failure();
  EXPECT_NEAR(again->summary.cost, base.summary.cost, 1e-6 * base.summary.cost);
  const Vector6d change = boxminus(again->imu.T_SC0, base.imu.T_SC0);
  EXPECT_LT(change.cwiseQuotient(*base.imu.T_SC0_std).norm(), 1e-3);
}

TEST(CameraImuAgain, AStretchThatCountsTwiceHalvesTheVariance) {
  const SimulatedSession s = simulate(noisyRecording(9, 8));
  CameraImuOptions options = matchedOptions(s, 0.2);
  options.tolerance = 1e-7;
  const CameraImuStageResult base = solved(s, options);
  const auto once = recalibrateCameraImu(s.session, base, {{0, 60, 1}, {80, 60, 1}}, options);
  const auto twice = recalibrateCameraImu(s.session, base, {{0, 60, 2}, {80, 60, 2}}, options);
  ASSERT_TRUE(once && twice);
  EXPECT_EQ(once->frames.size(), 120u);
  EXPECT_EQ(once->imu_residuals.size(), 118u);
  EXPECT_TRUE(
      (2 * twice->summary.covariance.matrix).isApprox(once->summary.covariance.matrix, 1e-4));
  EXPECT_LT(boxminus(twice->imu.T_SC0, once->imu.T_SC0).norm(), 1e-6);
}

}  // namespace
}  // namespace plumbline
