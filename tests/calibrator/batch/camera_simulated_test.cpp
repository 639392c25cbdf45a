// SPDX-License-Identifier: BSD-3-Clause
// Camera calibration of simulated recordings whose truth is known.
#include <algorithm>

#include <gtest/gtest.h>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/resample.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

SimulationOptions simulatedRecording(double sigma_px) {
  SimulationOptions options;
  options.duration_s = 12;
  options.camera_rate_hz = 5;
  options.corner_sigma_px = sigma_px;
  return options;
}

SimulatedSession simulated(const std::string& rig, const SimulationOptions& options) {
  return simulateSession(simulatedRig(rig), options);
}

CameraStageOptions squaredError(double pixel_sigma = 1) {
  CameraStageOptions options;
  options.cauchy_px = 0;
  options.pixel_sigma = pixel_sigma;
  return options;
}

/// All parameters, in the order of the covariance, of `result` minus the truth.
Eigen::VectorXd errorOf(const CameraStageResult& result, const Calibration& truth) {
  return cameraDifference(result.cameras, truth.cameras);
}

TEST(CameraBatch, RecoversTheTruthWithoutNoiseForEveryModel) {
  for (const char* rig : {"euroc", "tumvi", "d435i"}) {
    const SimulatedSession s = simulated(rig, simulatedRecording(0));
    const auto result = calibrateCameras(s.session);
    ASSERT_TRUE(result.ok()) << rig << ": " << result.failure();
    EXPECT_TRUE(result->summary.converged);
    const Eigen::VectorXd std = result->summary.covariance.standardDeviations();
    const Eigen::VectorXd error = errorOf(*result, s.truth);
    EXPECT_LT(error.cwiseQuotient(std).cwiseAbs().maxCoeff(), 1e-6) << rig;  // sigma: 1 px
    EXPECT_LT(result->summary.reprojection.rmse_px, 1e-8) << rig;
  }
}

TEST(CameraBatch, DoesNotDependOnTheNumberOfThreads) {
  const SimulatedSession s = simulated("euroc", simulatedRecording(0.2));
  CameraStageOptions options;
  const auto one = calibrateCameras(s.session, options);
  options.threads = 3;
  const auto three = calibrateCameras(s.session, options);
  ASSERT_TRUE(one.ok() && three.ok());
  EXPECT_EQ(one->summary.cost, three->summary.cost);
  EXPECT_EQ(one->summary.covariance.matrix, three->summary.covariance.matrix);
  EXPECT_EQ(errorOf(*one, s.truth), errorOf(*three, s.truth));
}

TEST(CameraBatch, TheOrderOfTheCamerasOnlyTurnsTheExtrinsicsRound) {
  const SimulatedSession s = simulated("euroc", simulatedRecording(0.2));
  Session swapped = s.session;
  std::swap(swapped.cameras[0], swapped.cameras[1]);
  const auto a = calibrateCameras(s.session);
  const auto b = calibrateCameras(swapped);
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_NEAR(a->summary.cost, b->summary.cost, 1e-11 * a->summary.cost);
  EXPECT_LT(boxminus(a->cameras[1].T_C0Ci, b->cameras[1].T_C0Ci.inverse()).norm(), 1e-9);
}

TEST(CameraBatch, OutliersAreRejectedAndCounted) {
  SimulationOptions recording = simulatedRecording(0.2);
  recording.outlier_fraction = 0.02;
  const SimulatedSession s = simulated("euroc", recording);
  CameraStageOptions options;
  options.filter = CornerFilter::kSigma;
  options.filter_sigmas = 5;
  const auto result = calibrateCameras(s.session, options);
  ASSERT_TRUE(result.ok()) << result.failure();
  const auto& summary = result->summary;
  const double rejected = static_cast<double>(summary.corners_offered - summary.corners_used);
  EXPECT_NEAR(rejected / static_cast<double>(summary.corners_offered), 0.02, 0.004);
  EXPECT_NEAR(summary.reprojection.rmse_px, 0.2 * std::sqrt(2), 0.01);
  const auto marked = std::count_if(result->residuals.begin(), result->residuals.end(),
                                    [](const CornerResidual& r) { return !r.used; });
  EXPECT_EQ(static_cast<double>(marked), rejected);
}

TEST(CameraBatch, SurvivesViewsOfASingleTag) {
  SimulatedSession s = simulated("euroc", simulatedRecording(0.1));
  for (CameraStream& camera : s.session.cameras) {
    for (std::size_t i = 0; i < camera.views.size(); i += 3) {
      auto& corners = camera.views[i].corners;
      if (corners.size() > 4) corners.resize(4);
    }
  }
  const auto result = calibrateCameras(s.session, squaredError(0.1));
  ASSERT_TRUE(result.ok()) << result.failure();
  EXPECT_NEAR(result->summary.reprojection.rmse_px, 0.1 * std::sqrt(2), 0.01);
}

TEST(CameraBatch, SelectedViewsAreFewerAndNearlyAsGood) {
  const SimulatedSession s = simulated("euroc", simulatedRecording(0.2));
  CameraStageOptions options = squaredError(0.2);
  const auto all = calibrateCameras(s.session, options);
  options.select_views = ViewSelectionOptions{};
  const auto some = calibrateCameras(s.session, options);
  ASSERT_TRUE(all.ok() && some.ok());
  EXPECT_LT(some->frames.size(), all->frames.size());
  EXPECT_GT(some->summary.entropy_nats, all->summary.entropy_nats);
}

TEST(CameraBatch, CamerasWithoutCommonViewsAreNamed) {
  SimulatedSession s = simulated("euroc", simulatedRecording(0.2));
  for (ImageView& view : s.session.cameras[1].views) view.t += 100'000'000'000;
  const auto result = calibrateCameras(s.session);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.failure().code, FailureCode::kCamerasShareNoFrame);
  EXPECT_NE(toString(result.failure()).find("apart cam1"), std::string::npos) << result.failure();
}

TEST(CameraBatch, ACameraWithoutViewsIsNamed) {
  SimulatedSession s = simulated("euroc", simulatedRecording(0.2));
  for (ImageView& view : s.session.cameras[1].views) view.corners.clear();
  const auto result = calibrateCameras(s.session);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.failure().code, FailureCode::kTooFewViews);
  EXPECT_NE(toString(result.failure()).find("camera cam1"), std::string::npos) << result.failure();
}

TEST(CameraBatch, FrontoParallelViewsLeaveTheFocalLengthFree) {
  SimulationOptions recording = simulatedRecording(0.2);
  recording.trajectory.kind = MotionKind::kFrontoParallel;
  const SimulatedSession s = simulated("euroc", recording);
  Session mono = s.session;
  mono.cameras.resize(1);
  const auto result = calibrateCameras(mono, squaredError());
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.failure().code, FailureCode::kFocalLengthFree);
}

TEST(DrawStretches, CoverTheFramesOnAverageAndRepeatWithTheSeed) {
  const ResampleOptions options{.draws = 2, .segments = 7, .seed = 3};
  const auto a = drawSegments(100, options, 0);
  double drawn = 0;
  int last = 0;
  for (const FrameSegment& s : a) {
    EXPECT_GE(s.first, last);
    last = s.first + s.count;
    drawn += s.weight;
  }
  EXPECT_LE(last, 100);
  EXPECT_EQ(drawn, 7);
  const auto b = drawSegments(100, options, 0);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].first, b[i].first);
}

}  // namespace
}  // namespace plumbline
