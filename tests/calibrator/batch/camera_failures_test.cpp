// SPDX-License-Identifier: BSD-3-Clause
// What the camera stage refuses, and in which words.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/calibration.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/stage.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

SimulatedSession recording(MotionKind motion = MotionKind::kFull) {
  SimulationOptions options;
  options.duration_s = 8;
  options.camera_rate_hz = 5;
  options.trajectory.kind = motion;
  return simulateSession(simulatedRig("euroc"), options);
}

std::string inputErrorOf(const Session& session, const CameraStageOptions& options = {}) {
  try {
    (void)calibrateCameras(session, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(CameraFailures, SessionsThatCannotBeCalibratedAreBadInput) {
  Session session = recording().session;
  session.cameras[1].resolution = {};
  EXPECT_THAT(inputErrorOf(session), HasSubstr("cam1: the image's resolution is unknown"));
  session.cameras.clear();
  EXPECT_THAT(inputErrorOf(session), HasSubstr("no cameras"));
}

TEST(CameraFailures, ModelsThatCannotBeCalibratedAreNamed) {
  Session session = recording().session;
  CameraStageOptions options;
  options.models = {{}, {ProjectionModel::kOmni, DistortionModel::kFov}};
  EXPECT_THAT(inputErrorOf(session, options),
              HasSubstr("cam1: calibrating the camera model omni-fov"));
  options.models.resize(1);
  EXPECT_THAT(inputErrorOf(session, options), HasSubstr("1 cameras were given"));
  session.cameras[0].camera_model = "omni";
  session.cameras[0].distortion_model = "equidistant";
  EXPECT_THAT(inputErrorOf(session), HasSubstr("camera model omni-equidistant"));
  // A start has models of its own: what the session says does not matter.
  options.models.clear();
  options.start = recording().truth.cameras;
  EXPECT_EQ(inputErrorOf(session, options), "no error");
  // Nor are they a start, though they could be scored.
  SimulatedSession s = recording();
  Intrinsics& k = s.truth.cameras[1].intrinsics;
  k.projection_model = ProjectionModel::kOmni;
  k.projection = (Eigen::VectorXd(5) << 1, 900, 900, 376, 240).finished();
  k.distortion_model = DistortionModel::kFov;
  k.distortion.setConstant(1, 0.1);
  CameraStageOptions from_start;
  from_start.start = s.truth.cameras;
  EXPECT_THAT(inputErrorOf(s.session, from_start),
              HasSubstr("cam1: calibrating the camera model omni-fov"));
}

TEST(CameraFailures, AStartMustHoldEveryCamera) {
  const SimulatedSession s = recording();
  CameraStageOptions options;
  options.start = {s.truth.cameras[0]};
  EXPECT_THAT(inputErrorOf(s.session, options), HasSubstr("calibrations of 1 cameras"));
}

// The recording has others, of which the failure is not one.
TEST(CameraFailures, OfASelectionSayHowManyFramesItLeft) {
  const Session session = recording().session;
  CameraStageOptions options;
  options.select_views = ViewSelectionOptions();
  options.select_views->threshold_bits = 1000;
  const auto few = calibrateCameras(session, options);
  ASSERT_FALSE(few.ok());
  EXPECT_GE(few.failure().number("selected_frames"), 1) << few.failure();
  EXPECT_LT(few.failure().number("selected_frames"), 5) << few.failure();
  EXPECT_EQ(few.failure().number("selected_from"), 40) << few.failure();
  // A solution that does not converge lacks no frames.
  CameraStageOptions short_run = options;
  short_run.select_views->threshold_bits = 0.5;
  short_run.max_iterations = 1;
  const auto rough = calibrateCameras(session, short_run);
  ASSERT_FALSE(rough.ok());
  EXPECT_EQ(rough.failure().code, FailureCode::kCamerasNotConverged) << rough.failure();
  EXPECT_EQ(rough.failure().values.count("selected_frames"), 0u) << rough.failure();
  options.select_views->threshold_bits = 0;
  const Session still = recording(MotionKind::kFrontoParallel).session;
  const auto all = calibrateCameras(still, options);
  ASSERT_FALSE(all.ok());
  EXPECT_EQ(all.failure().values.count("selected_frames"), 0u) << all.failure();
}

TEST(CameraFailures, TwoViewsAreTooFewAndTheNumbersAreTold) {
  Session session = recording().session;
  for (CameraStream& camera : session.cameras) camera.views.resize(2);
  const auto result = calibrateCameras(session);
  ASSERT_FALSE(result.ok());
  const Failure& f = result.failure();
  EXPECT_EQ(f.code, FailureCode::kTooFewViews);
  EXPECT_EQ(std::get<std::string>(f.values.at("camera").content()), "cam0");
  EXPECT_EQ(f.number("views"), 2);
}

TEST(CameraFailures, AViewFromOnePlaceLeavesTheFocalLengthFreeWhateverTheNoiseAssumed) {
  for (const MotionKind motion : {MotionKind::kStatic, MotionKind::kFrontoParallel}) {
    const SimulatedSession s = recording(motion);
    for (const double sigma_px : {1.0, 0.2}) {
      CameraStageOptions options;
      options.pixel_sigma = sigma_px;
      const auto result = calibrateCameras(s.session, options);
      ASSERT_FALSE(result.ok());
      EXPECT_EQ(result.failure().code, FailureCode::kFocalLengthFree);
      EXPECT_EQ(result.failure().reason(), FailureReason::kNotObservable);
      EXPECT_LT(result.failure().number("tilt_deg"), 25);
    }
  }
}

TEST(CameraFailures, ALensModelWithTooManyCoefficientsIsToldFromViewsThatAreAlike) {
  const SimulatedSession s = recording();
  CameraStageOptions options;
  options.models.assign(2, {ProjectionModel::kPinhole, DistortionModel::kRational});
  const auto result = calibrateCameras(s.session, options);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.failure().number("lens_held"), 1);
  EXPECT_GT(result.failure().number("tilt_deg"), 25);
  EXPECT_EQ(result.failure().number("coefficients"), 8);
}

TEST(CameraFailures, AScoreOfWhichAFilterLeavesNoFrameIsNone) {
  const SimulatedSession s = recording();
  CameraStageOptions options;
  options.filter = CornerFilter::kSigma;
  options.filter_sigmas = 1e-6;
  const auto result = scoreCameras(s.session, s.truth.cameras, options);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.failure().code, FailureCode::kNoFramePose);
}

TEST(CameraFailures, ACalibrationOfWhichAFilterLeavesNoFrameIsNone) {
  const SimulatedSession s = recording();
  CameraStageOptions options;
  options.filter = CornerFilter::kSigma;
  options.filter_sigmas = 1e-6;
  const auto result = calibrateCameras(s.session, options);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.failure().code, FailureCode::kFilterLeftNoFrame);
}

TEST(CameraFailures, AFreeDirectionIsNamedByItsParameterWhateverTheCamerasName) {
  CameraStageResult stage;
  stage.cameras = recording().truth.cameras;
  stage.cameras[0].name = "rig.fused";
  const auto n = static_cast<Eigen::Index>(cameraParameters(stage.cameras).size());
  const Eigen::MatrixXd information = 1e8 * Eigen::MatrixXd::Identity(n, n);
  const auto codeWithout = [&](Eigen::Index k) {
    Eigen::MatrixXd without = information;
    without(k, k) = 0;
    const auto failure = addCovariance(without, stage);
    EXPECT_TRUE(failure);
    EXPECT_EQ(std::get<std::string>(failure->values.at("camera").content()), k < 8    ? "rig.fused"
                                                                             : k < 16 ? "cam1"
                                                                                      : "T_C0C1");
    return failure->code;
  };
  EXPECT_EQ(codeWithout(1), FailureCode::kFocalLengthFree);
  EXPECT_EQ(codeWithout(3), FailureCode::kPrincipalPointFree);
  EXPECT_EQ(codeWithout(4), FailureCode::kDistortionFree);
  EXPECT_EQ(codeWithout(8), FailureCode::kFocalLengthFree);
  EXPECT_EQ(codeWithout(15), FailureCode::kDistortionFree);
  EXPECT_EQ(codeWithout(16), FailureCode::kExtrinsicsFree);
}

TEST(CameraFailures, ATargetOfAnotherLayoutDoesNotPassAsCalibrated) {
  SimulatedSession s = recording();
  s.session.target.spacing = 0.6;
  const auto result = calibrateCameras(s.session);
  if (result.ok()) {
    EXPECT_GT(result->summary.reprojection.rmse_px, 5);  // a bad verdict by itself
    return;
  }
  EXPECT_THAT(result.failure().code,
              ::testing::AnyOf(FailureCode::kNoFramePose, FailureCode::kNoPlausiblePose,
                               FailureCode::kCamerasNotConverged))
      << result.failure();
}

}  // namespace
}  // namespace plumbline
