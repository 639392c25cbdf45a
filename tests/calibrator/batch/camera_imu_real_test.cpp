// SPDX-License-Identifier: BSD-3-Clause
// The camera-IMU batch on EuRoC's imu_april with the published cameras: the optimum, Kalibr's run
// on the same corners, and IMU stamps moved by known amounts.
#include <algorithm>
#include <sstream>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/residuals/imu_residual.h"
#include "tests/calibrator/batch/euroc_recording.h"

namespace plumbline {
namespace {

const test::EurocRecording& recording() {
  static const test::EurocRecording r = test::readEurocRecording(PLUMBLINE_SHARED_DATA);
  return r;
}

CameraImuOptions squaredError() {
  CameraImuOptions options;  // pixel sigma 1, |g| = 9.80655, EuRoC's densities
  options.cauchy_px = 0;
  return options;
}

CameraImuStageResult solved(const CameraImuOptions& options) {
  auto result = calibrateCameraImu(recording().session, recording().published, options);
  if (!result) throw std::runtime_error(toString(result.failure()));
  return std::move(result).value();
}

/// By squared error, with covariances of all states.
const CameraImuStageResult& unmoved() {
  static const CameraImuStageResult result = [] {
    CameraImuOptions options = squaredError();
    options.state_covariances = true;
    return solved(options);
  }();
  return result;
}

/// T_cam_imu of cam0 in kalibr_runs/camera_imu/euroc-camchain-imucam.yaml, inverted.
Transform kalibrsT_SC0() {
  Eigen::Matrix4d T_C0S;
  T_C0S << 0.015016839778360769, 0.9996372351963206, -0.02235827659115831, 0.06821364110292438,
      -0.9998822699452553, 0.015083519709933157, 0.002816679300769988, -0.016057697480107245,
      0.0031528990142992916, 0.02231334672826455, 0.999746054648674, -0.002431259366521511, 0, 0, 0,
      1;
  return Transform::fromMatrix(T_C0S).inverse();
}

TEST(CameraImuEuroc, ReachesTheOptimumOverAllFrames) {
  const CameraImuStageResult& r = unmoved();
  EXPECT_TRUE(r.summary.converged);
  EXPECT_EQ(r.frames.size(), 1415u);
  EXPECT_NEAR(r.summary.reprojection.rmse_px, 0.5837, 0.0002);
  EXPECT_LT(std::abs(r.imu.timeOffset()), 10e-6);
  const Vector6d d = boxminus(r.imu.T_SC0, kalibrsT_SC0());
  EXPECT_LT(d.tail<3>().norm() * kDegrees, 0.05);
  EXPECT_LT(d.head<3>().norm(), 0.6e-3);
  EXPECT_NEAR(r.imu_summary.chi2, 8580, 20);  // of 21210 residuals: the states absorb most
}

TEST(CameraImuEuroc, IsNearerToKalibrsRunWithItsCornerFilter) {
  CameraImuOptions options = squaredError();
  options.filter = CornerFilter::kKalibr;
  const CameraImuStageResult r = solved(options);
  const Vector6d d = boxminus(r.imu.T_SC0, kalibrsT_SC0());
  EXPECT_LT(d.tail<3>().norm() * kDegrees, 0.02);
  EXPECT_LT(d.head<3>().norm(), 0.3e-3);
  const double rejected =
      1 - static_cast<double>(r.summary.corners_used) / static_cast<double>(r.residuals.size());
  EXPECT_NEAR(rejected, 0.038, 0.002);  // Kalibr's share
  EXPECT_NEAR(r.summary.per_camera[0].rmse_px, 0.5261, 0.003);
}

std::vector<TimeNs> stampsOf(const CameraImuStageResult& result) {
  std::vector<TimeNs> stamps;
  for (const Frame& frame : result.frames) stamps.push_back(frame.t);
  return stamps;
}

/// The largest change of any parameter but the offset, in its own standard deviations: T_SC0,
/// gravity, and every frame's pose, velocity and biases.
double largestChange(const CameraImuStageResult& moved, const CameraImuStageResult& base) {
  const auto& covariances = base.state_covariances.value();
  const Vector6d extrinsics = boxminus(moved.imu.T_SC0, base.imu.T_SC0);
  double largest = extrinsics.cwiseQuotient(*base.imu.T_SC0_std).cwiseAbs().maxCoeff();
  const Eigen::Vector3d down = base.gravity_F.normalized();
  const Eigen::Vector2d tilt = tangentBasis(down).transpose() * moved.gravity_F.normalized();
  const Eigen::Vector2d tilt_std = covariances.gravity_direction.diagonal().cwiseSqrt();
  largest = std::max(largest, tilt.cwiseQuotient(tilt_std).cwiseAbs().maxCoeff());
  for (std::size_t i = 0; i < base.states.size(); ++i) {
    const Vector15d change = boxminus(moved.states[i], base.states[i]);
    const Vector15d deviation = covariances.states[i].diagonal().cwiseSqrt();
    const double of_state = change.cwiseQuotient(deviation).cwiseAbs().maxCoeff();
    if (!(of_state <= largest)) largest = of_state;
  }
  return largest;
}

// More of them, by their offsets alone: evaluate/studies/perturbation_real_test.
TEST(CameraImuEuroc, MovedImuStampsAreRecovered) {
  const CameraImuStageResult& base = unmoved();
  ASSERT_TRUE(base.state_covariances);
  ASSERT_EQ(base.state_covariances->states.size(), base.states.size());
  double largest = 0;
  for (const double shift_ms : {1.0, 37.3, 100.0, -500.0, 1000.0, -1000.0}) {
    CameraImuOptions options = squaredError();
    options.imu_shift_ns = toNanoseconds(shift_ms * 1e-3);
    options.diagnose_faults = options.noise_check = false;
    const CameraImuStageResult moved = solved(options);
    ASSERT_EQ(stampsOf(moved), stampsOf(base)) << shift_ms;
    const double recovered = moved.imu.timeOffset() - base.imu.timeOffset();
    EXPECT_LT(std::abs(recovered - shift_ms * 1e-3), 0.1e-6) << shift_ms;
    const double change = largestChange(moved, base);
    EXPECT_LT(change, 0.01) << shift_ms;
    largest = std::max(largest, change);
  }
  std::ostringstream text;
  text << largest;
  RecordProperty("largest_change_in_sigmas", text.str());
}

TEST(CameraImuEuroc, TheCauchyLossConvergesNearby) {
  CameraImuOptions options;  // Cauchy 1.5 px is the default
  const CameraImuStageResult r = solved(options);
  EXPECT_TRUE(r.summary.converged);
  EXPECT_LE(r.summary.iterations, 18);
  EXPECT_LT(std::abs(r.imu.timeOffset()), 20e-6);
  EXPECT_LT(boxminus(r.imu.T_SC0, kalibrsT_SC0()).head<3>().norm(), 0.6e-3);
}

}  // namespace
}  // namespace plumbline
