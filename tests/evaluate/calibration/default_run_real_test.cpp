// SPDX-License-Identifier: BSD-3-Clause
// A default run on EuRoC's imu_april, held against the images of cam_april: another day, the same
// rig and board. cam_april's corners are our detector's.
#include <gtest/gtest.h>

#include "evaluate/calibration/calibrate_session.h"

namespace plumbline {
namespace {

const std::string kData = PLUMBLINE_SHARED_DATA;

LoadRequest recording(const char* name) {
  LoadRequest request;
  request.session = kData + name;
  request.read.supported_models_only = false;
  return request;
}

/// As the command line asks for it by default.
const CalibrationRecord& defaultRun() {
  static const CalibrationRecord record = [] {
    CalibrateRequest request;
    request.load = recording("/euroc_imu_april");
    request.load.target = TargetMode::kAuto;
    request.camera.target = TargetMode::kAuto;
    request.camera.model_mode = ModelMode::kAuto;
    request.camera.threads = 2;
    request.camera_imu.threads = 2;
    return *calibrateSession(request, [](const std::string&, double) {});
  }();
  return record;
}

const Session& camApril() {
  static const Session session =
      loadSession(recording("/euroc_cam_april_images"), [](const std::string&, double) {}).session;
  return session;
}

double scoredOn(const Session& session) {
  CameraStageOptions options;
  options.cauchy_px = 0;
  const auto score = scoreCameras(session, defaultRun().camera->cameras, options);
  EXPECT_TRUE(score.ok());
  return score->summary.reprojection.rmse_px;
}

TEST(DefaultRunReal, ChoosesTheLensThatHoldsAndBendsTheBoard) {
  const CameraStageResult& stage = *defaultRun().camera;
  ASSERT_EQ(stage.models.size(), 2U);
  for (const ModelChoice& choice : stage.models) {
    EXPECT_EQ(choice.projection, ProjectionModel::kPinhole);
    EXPECT_EQ(choice.distortion, DistortionModel::kEquidistant);
    EXPECT_EQ(choice.reason, ModelReason::kSmallest);
  }
  ASSERT_TRUE(stage.target_fit);
  EXPECT_EQ(stage.target_fit->finding, TargetFinding::kBent);
  EXPECT_FALSE(stage.target.isFlat());
}

TEST(DefaultRunReal, ItsHalvesAgreeWithinTheirDeviations) {
  const auto& halves = defaultRun().camera->summary.halves;
  ASSERT_TRUE(halves);
  for (const HalvesBlock& b : halves->blocks) EXPECT_TRUE(b.agree()) << b.name << " " << b.chi2;
}

TEST(DefaultRunReal, HoldsOnAnotherDay) {
  EXPECT_LT(scoredOn(camApril()), 0.24);  // radtan and a flat board left 0.919
}

TEST(DefaultRunReal, HoldsBetterWithThatDaysBoard) {
  CameraStageOptions options;
  options.start = defaultRun().camera->cameras;
  options.cauchy_px = 0;
  options.target = TargetMode::kEstimate;
  const auto own = calibrateCameras(camApril(), options);
  ASSERT_TRUE(own.ok());
  Session bent = camApril();
  bent.target.shape = own->target;
  EXPECT_LT(scoredOn(bent), 0.11);
}

}  // namespace
}  // namespace plumbline
