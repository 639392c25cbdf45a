// SPDX-License-Identifier: BSD-3-Clause
// Every model that can be calibrated, on simulated cameras; and the choice among them.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/model_choice.h"
#include "calibrator/batch/camera/stage.h"
#include "calibrator/batch/corners.h"
#include "calibrator/camera/camera.h"
#include "calibrator/initialise/lens_fit.h"
#include "calibrator/simulate/simulate_session.h"
#include "tests/calibrator/camera/example_cameras.h"

namespace plumbline {
namespace {

/// A recording of one camera; the session says nothing of its model.
SimulatedSession recorded(const Intrinsics& lens, double sigma_px, double duration_s = 16,
                          std::uint64_t seed = SimulationOptions().seed) {
  SimulatedRig rig = simulatedRig("euroc");
  rig.calibration.cameras.resize(1);
  rig.calibration.cameras[0].intrinsics = lens;
  SimulationOptions options;
  options.duration_s = duration_s;
  options.camera_rate_hz = 5;
  options.corner_sigma_px = sigma_px;
  options.seed = seed;
  SimulatedSession s = simulateSession(rig, options);
  s.session.cameras[0].camera_model.clear();
  s.session.cameras[0].distortion_model.clear();
  return s;
}

/// Whatever the lens is.
SimulatedSession statedRadtan(SimulatedSession s) {
  s.session.cameras[0].camera_model = "pinhole";
  s.session.cameras[0].distortion_model = "radtan";
  return s;
}

CameraStageOptions as(const Intrinsics& lens) {
  CameraStageOptions options;
  options.models = {{lens.projection_model, lens.distortion_model}};
  options.cauchy_px = 0;
  options.pixel_sigma = 0.1;
  return options;
}

std::string nameOf(const Intrinsics& lens) {
  return toString(lens.projection_model) + "-" + toString(lens.distortion_model);
}

/// Largest angle to the axis at which a used corner was seen [rad].
double widestAngle(const CameraStageResult& result) {
  double widest = 0;
  for (const CornerResidual& r : result.residuals) {
    if (!r.used) continue;
    const auto ray = unproject(result.cameras[0].intrinsics, r.uv.cast<double>());
    if (ray) widest = std::max(widest, std::acos(ray->z()));
  }
  return widest;
}

/// EuRoC's cam0 in the models that have no example of their own size.
Intrinsics lensOf(ProjectionModel projection, DistortionModel distortion) {
  for (const Intrinsics& lens : test::everyModel()) {
    if (lens.projection_model == projection && lens.distortion_model == distortion) return lens;
  }
  return {};
}

TEST(CameraModels, EveryModelRecoversTheLensWithoutNoise) {
  for (const CameraModelPair& model : candidateModels()) {
    const Intrinsics lens = lensOf(model.projection, model.distortion);
    const SimulatedSession s = recorded(lens, 0);
    CameraStageOptions options = as(lens);
    options.pixel_sigma = 5e-3;     // rational's coefficients are observable to no less
    options.max_iterations = 1000;  // omni-radtan's way along a flat valley takes 585
    const auto result = calibrateCameras(s.session, options);
    ASSERT_TRUE(result.ok()) << nameOf(lens) << ": " << result.failure();
    EXPECT_LT(result->summary.reprojection.rmse_px, 1e-5) << nameOf(lens);
    const Eigen::VectorXd std = result->summary.covariance.standardDeviations();
    const Eigen::VectorXd error = result->cameras[0].intrinsics.stacked() - lens.stacked();
    EXPECT_LT(error.cwiseQuotient(std).cwiseAbs().maxCoeff(), 1e-3) << nameOf(lens);
  }
}

/// A fisheye that shows 195 degrees over the height of the image, in this model.
Intrinsics fisheye(ProjectionModel projection) {
  Intrinsics lens = test::doubleSphereCamera();
  lens.resolution = {752, 752};
  lens.projection << -0.2, 0.59, 1, 1, 374.1, 377.3;
  const double half = 195 * std::numbers::pi / 360;
  const auto edge = project(lens, {std::sin(half), 0, std::cos(half)});
  const double focal = 376 / (edge->x() - 374.1);
  lens.projection.segment<2>(2).setConstant(focal);
  if (projection == ProjectionModel::kDs) return lens;
  const DistortionModel none = DistortionModel::kNone;
  return convertedLens(lens, projection, none)->lens;
}

TEST(CameraModels, FisheyesOf195DegreesAreCalibratedBeyondTheRightAngle) {
  for (const ProjectionModel projection :
       {ProjectionModel::kDs, ProjectionModel::kEucm, ProjectionModel::kOmni}) {
    const Intrinsics lens = fisheye(projection);
    const SimulatedSession s = recorded(lens, 0.1);
    const auto result = calibrateCameras(s.session, as(lens));
    ASSERT_TRUE(result.ok()) << nameOf(lens) << ": " << result.failure();
    EXPECT_NEAR(result->summary.reprojection.rmse_px, 0.1 * std::sqrt(2), 0.004) << nameOf(lens);
    EXPECT_GT(widestAngle(*result), 0.5 * std::numbers::pi) << nameOf(lens);
    const Eigen::VectorXd std = result->summary.covariance.standardDeviations();
    const Eigen::VectorXd error = result->cameras[0].intrinsics.stacked() - lens.stacked();
    EXPECT_LT(error.cwiseQuotient(std).cwiseAbs().maxCoeff(), 4.5) << nameOf(lens);
  }
}

CameraStageOptions chosen() {
  CameraStageOptions options;
  options.model_mode = ModelMode::kAuto;
  return options;
}

TEST(ModelChoice, FindsTheModelOfTheLens) {
  for (const Intrinsics& lens : {test::equidistantCamera(), fisheye(ProjectionModel::kDs)}) {
    const SimulatedSession s = recorded(lens, 0.1, 30);
    const auto result = calibrateCameras(s.session, chosen());
    ASSERT_TRUE(result.ok()) << nameOf(lens) << ": " << result.failure();
    ASSERT_EQ(result->models.size(), 1U);
    const ModelChoice& choice = result->models[0];
    // Another may describe the lens as well; never one that leaves more than the noise.
    EXPECT_NEAR(result->summary.reprojection.rmse_px, 0.1 * std::sqrt(2), 0.004) << nameOf(lens);
    EXPECT_NE(choice.reason, ModelReason::kNotTested);
    EXPECT_EQ(choice.candidates.size(), candidateModels().size());
    for (std::size_t i = 1; i < choice.candidates.size(); ++i) {
      if (choice.candidates[i].frames < choice.candidates[0].frames) break;
      EXPECT_GE(choice.candidates[i].excess_px2, 0);
    }
  }
}

// Held-out frames hardly tell a model without tangential terms from it, and T_SC0 turned by 0.15
// deg without them.
TEST(ModelChoice, ADecentredLensKeepsItsTangentialTerms) {
  Intrinsics lens = test::radtanCamera();
  lens.projection.head<2>().setConstant(600);
  lens.distortion << -0.05, 0.01, 6e-4, -6e-4;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const auto result = calibrateCameras(recorded(lens, 0.5, 12, seed).session, chosen());
    ASSERT_TRUE(result.ok()) << result.failure();
    EXPECT_EQ(result->models[0].distortion, DistortionModel::kRadtan) << seed;
    EXPECT_EQ(result->models[0].reason, ModelReason::kTangential) << seed;
  }
}

TEST(ModelChoice, KeepsTheStatedModelWhereNoneIsBetter) {
  const SimulatedSession s = statedRadtan(recorded(test::radtanCamera(), 0.2, 30));
  const auto result = calibrateCameras(s.session, chosen());
  ASSERT_TRUE(result.ok()) << result.failure();
  EXPECT_EQ(result->models[0].reason, ModelReason::kStated);
  EXPECT_EQ(result->models[0].distortion, DistortionModel::kRadtan);
  CameraStageOptions given = as(test::radtanCamera());
  given.cauchy_px = CameraStageOptions().cauchy_px;
  given.pixel_sigma = CameraStageOptions().pixel_sigma;
  const auto same = calibrateCameras(s.session, given);
  ASSERT_TRUE(same.ok());
  EXPECT_NEAR(result->summary.cost, same->summary.cost, 1e-9 * same->summary.cost);
}

TEST(ModelChoice, LeavesAStatedModelThatMisfits) {
  const SimulatedSession s = statedRadtan(recorded(test::equidistantCamera(), 0.2, 30));
  const auto result = calibrateCameras(s.session, chosen());
  ASSERT_TRUE(result.ok()) << result.failure();
  EXPECT_EQ(result->models[0].reason, ModelReason::kSmallest);
  EXPECT_NEAR(result->summary.reprojection.rmse_px, 0.2 * std::sqrt(2), 0.01);
}

// Under this noise the stated models of both cameras are as good as any; together they get one.
TEST(ModelChoice, AModelForTheSakeOfAllCamerasIsSaidToBeThat) {
  SimulatedRig rig = simulatedRig("euroc");
  for (CameraCalibration& camera : rig.calibration.cameras) {
    camera.intrinsics.distortion << -0.1, 0.01, 0, 0;
  }
  SimulationOptions simulation;
  simulation.duration_s = 10;
  simulation.camera_rate_hz = 5;
  simulation.corner_sigma_px = 0.3;
  SimulatedSession s = simulateSession(rig, simulation);
  const std::array<DistortionModel, 2> stated{DistortionModel::kRadtan,
                                              DistortionModel::kEquidistant};
  for (std::size_t c = 0; c < 2; ++c) {
    s.session.cameras[c].camera_model = "pinhole";
    s.session.cameras[c].distortion_model = toString(stated[c]);
  }
  const auto result = calibrateCameras(s.session, chosen());
  ASSERT_TRUE(result.ok()) << result.failure();
  const auto& models = result->models;
  ASSERT_EQ(models.size(), 2U);
  ASSERT_EQ(models[0].distortion, models[1].distortion);
  for (std::size_t c = 0; c < 2; ++c) {
    const bool as_stated =
        models[c].projection == ProjectionModel::kPinhole && models[c].distortion == stated[c];
    EXPECT_EQ(models[c].reason, as_stated ? ModelReason::kStated : ModelReason::kCommon);
  }
}

// A tangential distortion of half a pixel: under equidistant it costs 0.002 px, and turns the
// camera.
TEST(ModelChoice, ARigOfTwoKindsOfLensKeepsThem) {
  SimulatedRig rig = simulatedRig("euroc");
  rig.calibration.cameras[0].intrinsics.distortion << -0.28, 0.07, 7e-4, -4e-4;
  Intrinsics& fisheye = rig.calibration.cameras[1].intrinsics;
  fisheye.distortion_model = DistortionModel::kEquidistant;
  fisheye.distortion << -0.012, 0.01, -0.009, 0.003;
  SimulationOptions simulation;
  simulation.duration_s = 20;
  simulation.camera_rate_hz = 5;
  simulation.corner_sigma_px = 0.2;
  SimulatedSession s = simulateSession(rig, simulation);
  for (std::size_t c = 0; c < 2; ++c) {
    s.session.cameras[c].camera_model = "pinhole";
    s.session.cameras[c].distortion_model =
        toString(rig.calibration.cameras[c].intrinsics.distortion_model);
  }
  const auto result = calibrateCameras(s.session, chosen());
  ASSERT_TRUE(result.ok()) << result.failure();
  EXPECT_EQ(result->models[0].reason, ModelReason::kStated);
  EXPECT_EQ(result->models[0].distortion, DistortionModel::kRadtan);
  // The second may be described by another as well; its rotation is that of the truth in any case.
  const Eigen::Matrix3d turn =
      result->cameras[1].T_C0Ci.R.transpose() * rig.calibration.cameras[1].T_C0Ci.R;
  EXPECT_LT(rotationAngle(turn), 0.03 * std::numbers::pi / 180);
}

// Its coefficients gain nothing over radtan's, but it is what the recording says.
TEST(ModelChoice, AStatedModelIsTriedToTheEndWhateverItsParameters) {
  Intrinsics lens = test::radtanCamera();
  lens.distortion << -0.1, 0.01, 0, 0;  // any model describes it
  SimulatedSession s = recorded(lens, 0.3, 40);
  s.session.cameras[0].camera_model = "pinhole";
  s.session.cameras[0].distortion_model = "rational";
  CameraCalibration stated = s.truth.cameras[0];
  stated.intrinsics.distortion_model = DistortionModel::kRational;
  stated.intrinsics.distortion = Eigen::VectorXd::Zero(8);
  stated.intrinsics.distortion.head<4>() = lens.distortion;
  const CameraStageOptions options = chosen();
  const std::vector<PackedCorners> corners = packCorners(s.session);
  const auto start =
      startFromCameras({stated}, corners, pairFrames(s.session.cameras, options.frames), options);
  ASSERT_TRUE(start.ok()) << start.failure();
  const CameraProblem problem = problemOf(corners, start->frames, options);
  const ChosenModels models = chooseModels(s.session, problem, start->estimate, options);
  const auto& candidates = models.choices[0].candidates;
  ASSERT_EQ(candidates.size(), candidateModels().size());
  const auto rational =
      std::ranges::find(candidates, DistortionModel::kRational, &ModelCandidate::distortion);
  ASSERT_NE(rational, candidates.end());
  EXPECT_EQ(rational->frames, candidates.front().frames);
}

// A board of one tag: the model that predicts its four corners best may not be determined by them.
TEST(ModelChoice, TheStatedModelsStandInForThoseThatAreNotDetermined) {
  SimulationOptions simulation;
  simulation.duration_s = 20;
  simulation.camera_rate_hz = 10;
  Session session = simulateSession(simulatedRig("euroc"), simulation).session;
  session.target.rows = session.target.cols = 1;
  for (CameraStream& camera : session.cameras) {
    camera.camera_model = "pinhole";
    camera.distortion_model = "radtan";
    for (ImageView& view : camera.views) {
      std::erase_if(view.corners, [](const Corner& corner) { return corner.id / 4 != 14; });
      for (Corner& corner : view.corners) corner.id %= 4;
    }
  }
  CameraStageOptions stated;
  ASSERT_TRUE(calibrateCameras(session, stated).ok());
  const auto result = calibrateCameras(session, chosen());
  ASSERT_TRUE(result.ok()) << result.failure();
  for (const ModelChoice& choice : result->models) EXPECT_FALSE(choice.candidates.empty());
}

TEST(ModelChoice, CandidatesOfAnEarlierChoiceStandLastAndWithoutFigures) {
  ModelCandidate radtan, ds, rational;
  radtan.distortion = DistortionModel::kRadtan;
  radtan.held_out_px = 0.3;
  ds.projection = ProjectionModel::kDs;
  ds.distortion = DistortionModel::kNone;
  ds.held_out_px = std::numeric_limits<double>::quiet_NaN();
  rational.distortion = DistortionModel::kRational;
  rational.held_out_px = 0.2;
  std::vector<ModelChoice> earlier(1), choices(1);
  earlier[0].candidates = {rational, radtan};
  choices[0].candidates = {radtan, ds};
  addCandidates(earlier, choices);
  ASSERT_EQ(choices[0].candidates.size(), 3U);
  EXPECT_EQ(choices[0].candidates[0].distortion, DistortionModel::kRadtan);
  EXPECT_EQ(choices[0].candidates[1].projection, ProjectionModel::kDs);
  EXPECT_EQ(choices[0].candidates[2].distortion, DistortionModel::kRational);
  EXPECT_TRUE(std::isnan(choices[0].candidates[2].held_out_px));
}

TEST(HeldOutError, NoBlockOrOneHasNoScatter) {
  for (const std::vector<double>& costs : {std::vector<double>{}, std::vector<double>{0.1}}) {
    const MeanGain gain = meanGain(costs, costs);
    EXPECT_EQ(gain.mean, 0);
    EXPECT_EQ(gain.std, 0);
  }
}

TEST(HeldOutError, SaysWhetherItsSolutionsHaveConverged) {
  const SimulatedSession s = recorded(test::radtanCamera(), 0.2, 6);
  const CameraStageOptions options = chosen();
  const std::vector<PackedCorners> corners = packCorners(s.session);
  const auto start = startFromCameras(s.truth.cameras, corners,
                                      pairFrames(s.session.cameras, options.frames), options);
  ASSERT_TRUE(start.ok()) << start.failure();
  const CameraProblem problem = problemOf(corners, start->frames, options);
  EXPECT_TRUE(heldOut(problem, start->estimate).converged);
  MinimiserOptions none = roughSolver();
  none.max_iterations = 1;
  none.tolerance = 1e-9;
  EXPECT_FALSE(
      heldOut(problem, start->estimate, BoardDetail::kTwelve, kFramesOfTest, none).converged);
}

TEST(HeldOutError, FramesOfOneBlockAreNotScored) {
  const SimulatedSession s = recorded(test::radtanCamera(), 0.1, 0.5);
  const CameraStageOptions options = chosen();
  const std::vector<PackedCorners> corners = packCorners(s.session);
  const auto start = startFromCameras(s.truth.cameras, corners,
                                      pairFrames(s.session.cameras, options.frames), options);
  ASSERT_TRUE(start.ok()) << start.failure();
  ASSERT_LT(start->frames.size(), 4U);  // two in a block
  const HeldOut error = heldOut(problemOf(corners, start->frames, options), start->estimate);
  EXPECT_EQ(error.frames, 0);
  EXPECT_TRUE(error.cost.empty());
}

TEST(ModelChoice, DoesNotDependOnTheNumberOfThreads) {
  const SimulatedSession s = recorded(test::eucmCamera(), 0.2);
  CameraStageOptions options = chosen();
  const auto one = calibrateCameras(s.session, options);
  options.threads = 3;
  const auto three = calibrateCameras(s.session, options);
  ASSERT_TRUE(one.ok() && three.ok());
  EXPECT_EQ(one->summary.cost, three->summary.cost);
  ASSERT_EQ(one->models[0].candidates.size(), three->models[0].candidates.size());
  for (std::size_t i = 0; i < one->models[0].candidates.size(); ++i) {
    const double a = one->models[0].candidates[i].held_out_px;
    const double b = three->models[0].candidates[i].held_out_px;
    EXPECT_TRUE(a == b || (std::isnan(a) && std::isnan(b)));
  }
}

}  // namespace
}  // namespace plumbline
