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
    EXPECT_TRUE(choice.reason == ModelReason::kSmallest || choice.reason == ModelReason::kCommon);
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
  EXPECT_LT(scoredOn(bent), 0.10);
}

/// fu, fv, pu, pv [px], the focal lengths as they are on the optical axis, whatever the model.
Eigen::Vector4d onAxis(const Intrinsics& lens) {
  Eigen::Vector4d f = lens.projection.tail<4>();
  const bool shifted = lens.projection_model == ProjectionModel::kDs ||
                       lens.projection_model == ProjectionModel::kOmni;
  if (shifted) f.head<2>() /= 1 + lens.projection[0];
  return f;
}

/// Largest difference over the cameras of these.
Eigen::Vector4d lensDifference(const CameraStageResult& a, const CameraStageResult& b) {
  Eigen::Vector4d largest = Eigen::Vector4d::Zero();
  for (std::size_t c = 0; c < a.cameras.size(); ++c) {
    const Eigen::Vector4d d = onAxis(a.cameras[c].intrinsics) - onAxis(b.cameras[c].intrinsics);
    largest = largest.cwiseMax(d.cwiseAbs());
  }
  return largest;
}

TEST(DefaultRunReal, AnotherDaysRecordingHasTheSameLens) {
  CameraStageOptions options;
  options.model_mode = ModelMode::kAuto;
  options.target = TargetMode::kAuto;
  const auto other = calibrateCameras(camApril(), options);
  ASSERT_TRUE(other.ok());
  const Eigen::Vector4d d = lensDifference(*defaultRun().camera, *other);
  EXPECT_LT(d.head<2>().maxCoeff(), 0.6);
  EXPECT_LT(d.tail<2>().maxCoeff(), 0.5);
}

/// Every third pair of cam_april from the given one on: nine of them.
Session handful(int from) {
  Session part = camApril();
  for (CameraStream& camera : part.cameras) {
    std::vector<ImageView> views;
    for (std::size_t i = static_cast<std::size_t>(from); i < camera.views.size(); i += 3) {
      views.push_back(camera.views[i]);
    }
    camera.views = views;
  }
  return part;
}

// Know the board, choose the lens, and a handful of views is enough.
TEST(DefaultRunReal, ItsBoardHelpsAHandfulOfViewsOfAnotherDay) {
  CameraStageOptions options;
  options.models.assign(2, {ProjectionModel::kPinhole, DistortionModel::kEquidistant});
  const auto all = [&] {
    CameraStageOptions free = options;
    free.target = TargetMode::kEstimate;
    return calibrateCameras(camApril(), free);
  }();
  ASSERT_TRUE(all.ok());
  for (int from = 0; from < 3; ++from) {
    Session few = handful(from);
    options.target = TargetMode::kGiven;
    const auto flat = calibrateCameras(few, options);
    few.target.shape = defaultRun().camera->target;
    options.target = TargetMode::kKnown;
    const auto known = calibrateCameras(few, options);
    ASSERT_TRUE(flat.ok() && known.ok()) << from;
    const double by_flat = lensDifference(*flat, *all).norm();
    const double by_known = lensDifference(*known, *all).norm();
    EXPECT_LT(by_known, 0.7 * by_flat) << from;
    EXPECT_LT(known->summary.reprojection.rmse_px, 0.6 * flat->summary.reprojection.rmse_px);
  }
}

/// A half of imu_april, split at 36 s, as the command line calibrates it.
CalibrationRecord halfRun(bool first) {
  CalibrateRequest request;
  request.load = recording("/euroc_imu_april");
  if (first) {
    request.load.read.to_s = 36;
  } else {
    request.load.read.from_s = 36;
  }
  request.camera.target = TargetMode::kAuto;
  request.camera.model_mode = ModelMode::kAuto;
  request.camera.threads = 2;
  request.camera_imu.threads = 2;
  request.halves = false;
  return *calibrateSession(request, [](const std::string&, double) {});
}

TEST(DefaultRunReal, HalvesOfTheRecordingGiveOneCalibration) {
  const CalibrationRecord first = halfRun(true), rest = halfRun(false);
  const Eigen::Vector4d d = lensDifference(*first.camera, *rest.camera);
  EXPECT_LT(d.head<2>().maxCoeff(), 0.5);
  EXPECT_LT(d.tail<2>().maxCoeff(), 0.6);  // the bar of 0.3 px is missed (docs/target_shape.md)
  const Eigen::Vector3d arm = first.camera_imu->imu.T_SC0.t - rest.camera_imu->imu.T_SC0.t;
  EXPECT_LT(arm.cwiseAbs().maxCoeff(), 3e-3);
}

TEST(DefaultRunReal, DeviationsOfTheLeverArmHoldWhatTheCamerasAdd) {
  const CameraImuStageResult& stage = *defaultRun().camera_imu;
  ASSERT_TRUE(stage.summary.robust_std && stage.faults);
  const Eigen::Vector3d both = stage.summary.robust_std->head<3>();
  const Eigen::Vector3d own = stage.faults->robust_std.head<3>();
  EXPECT_TRUE((both.array() > own.array()).all());
  EXPECT_LT(both.maxCoeff(), 3e-3);
}

}  // namespace
}  // namespace plumbline
