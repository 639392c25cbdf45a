// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/calibration/score.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/simulate/simulate_session.h"
#include "evaluate/session/load_session.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kSigma = 0.2;  // [px], per axis

void noProgress(const std::string&, double) {}

SimulatedSession recording() {
  SimulationOptions simulation;
  simulation.duration_s = 8;
  simulation.camera_rate_hz = 10;
  simulation.corner_sigma_px = kSigma;
  return simulateSession(simulatedRig("euroc"), simulation);
}

struct Case {
  SimulatedSession simulated = recording();
  ScoredCalibration scored{"truth", simulated.truth};
  ScoreOptions options;

  Case() {
    options.camera.pixel_sigma = options.camera_imu.pixel_sigma = kSigma;
    options.camera.cauchy_px = options.camera_imu.cauchy_px = 0;
    options.camera_imu.gravity_m_s2 = simulated.gravity_F.norm();
  }

  std::vector<CalibrationScore> run() const {
    const Session& session = simulated.session;
    const Calibration matched = matchCalibration(scored.calibration, "truth.json", session);
    return scoreSession({scored.label, matched}, session, options, noProgress).scores;
  }
};

TEST(ScoreCalibration, TheTruthLeavesTheNoise) {
  const Case c;
  const auto scores = c.run();
  ASSERT_EQ(scores.size(), 1u);
  const CalibrationScore& s = scores.front();
  EXPECT_EQ(s.problem, "");
  EXPECT_EQ(s.part, "all");
  EXPECT_FALSE(s.held_out);
  // Two residuals a corner, less six of each pose over some 250 corners.
  EXPECT_NEAR(s.reprojection.rmse_px, kSigma * std::sqrt(2.0), 0.03 * kSigma);
  ASSERT_EQ(s.per_camera.size(), 2u);
  EXPECT_EQ(s.cameras, (std::vector<std::string>{"cam0", "cam1"}));
  EXPECT_NEAR(s.per_camera[1].rmse_px, kSigma * std::sqrt(2.0), 0.03 * kSigma);
  ASSERT_TRUE(s.camera_imu);
  EXPECT_NEAR(s.camera_imu->rmse_px, kSigma * std::sqrt(2.0), 0.03 * kSigma);
  // Eight intrinsics a camera and one transform.
  ASSERT_TRUE(s.entropy_nats);
  EXPECT_EQ(s.entropy_parameters.size(), 22u);
}

TEST(ScoreCalibration, FoldsTellOverfittingFromKnowledge) {
  Case c;
  c.options.folds = 3;
  c.options.use_imu = false;
  const auto scores = c.run();
  ASSERT_EQ(scores.size(), 9u);  // the whole, two for each fold, two of all
  for (int k = 0; k < 3; ++k) {
    const CalibrationScore& in_sample = scores[1 + 2 * k];
    const CalibrationScore& held_out = scores[2 + 2 * k];
    EXPECT_EQ(in_sample.part, held_out.part);
    EXPECT_FALSE(in_sample.held_out);
    EXPECT_TRUE(held_out.held_out);
    EXPECT_GT(in_sample.reprojection.count, 1.5 * held_out.reprojection.count);
    EXPECT_FALSE(held_out.camera_imu);
  }
  const CalibrationScore& in_sample = scores[7];
  const CalibrationScore& held_out = scores[8];
  EXPECT_EQ(held_out.part, "all 3 folds");
  EXPECT_TRUE(held_out.held_out);
  EXPECT_EQ(held_out.reprojection.count, scores[0].reprojection.count);  // each corner once
  EXPECT_GT(held_out.reprojection.rmse_px, in_sample.reprojection.rmse_px);
  EXPECT_GT(held_out.reprojection.rmse_px, scores[0].reprojection.rmse_px);  // truth's own score
  EXPECT_NEAR(held_out.reprojection.rmse_px, scores[0].reprojection.rmse_px, 0.05 * kSigma);
}

TEST(ScoreCalibration, FoldsScoreTheImuToo) {
  Case c;
  c.options.folds = 2;
  const auto scores = c.run();
  ASSERT_EQ(scores.size(), 7u);
  for (const CalibrationScore& s : scores) {
    EXPECT_EQ(s.problem, "") << s.part;
    ASSERT_TRUE(s.camera_imu) << s.part;
    EXPECT_NEAR(s.camera_imu->rmse_px, kSigma * std::sqrt(2.0), 0.2 * kSigma) << s.part;
  }
}

TEST(ScoreCalibration, AFoldThatCannotBeCalibratedIsNotToldWhatCalibrateIs) {
  Case c;
  for (CameraStream& camera : c.simulated.session.cameras) camera.views.resize(4);
  c.options.folds = 2;
  c.options.use_imu = false;
  for (const CalibrationScore& s : c.run()) {
    if (s.part == "all") continue;
    EXPECT_THAT(s.problem, HasSubstr("2 views")) << s.part;
    EXPECT_THAT(s.problem, HasSubstr("more --folds")) << s.part;
    EXPECT_THAT(s.problem, Not(HasSubstr("target.yaml"))) << s.part;
  }
}

TEST(ScoreCalibration, AFoldOfABadImuIsToldItsCureAndNotMoreFolds) {
  Case c;
  for (ImuSample& sample : c.simulated.session.imu->samples) sample.accel /= 9.80665;
  c.options.folds = 2;
  for (const CalibrationScore& s : c.run()) {
    if (s.part == "all") continue;
    EXPECT_THAT(s.problem, HasSubstr("multiply its columns by 9.80665")) << s.part;
    EXPECT_THAT(s.problem, Not(HasSubstr("more --folds"))) << s.part;
  }
}

TEST(ScoreCalibration, ModelsThatAreOnlyScoredHaveNoFolds) {
  Case c;
  for (CameraCalibration& camera : c.scored.calibration.cameras) {
    Intrinsics& k = camera.intrinsics;  // omni-fov, which projects but is not calibrated
    k.projection_model = ProjectionModel::kOmni;
    k.distortion_model = DistortionModel::kFov;
    k.projection = (Eigen::VectorXd(5) << 0.5, k.projection).finished();
    k.distortion = Eigen::VectorXd::Constant(1, 0.4);
  }
  c.options.folds = 3;
  const auto scores = c.run();
  ASSERT_EQ(scores.size(), 2u);
  EXPECT_GT(scores[0].reprojection.rmse_px, 5 * kSigma);  // another lens
  EXPECT_THAT(scores[1].problem, HasSubstr("scored but not calibrated"));
}

TEST(ScoreCalibration, ReversedCamerasAreTheSameCalibration) {
  // The file lists cam1 first, so that its T_C0Ci and T_SC0 are cam1's.
  Case c;
  const auto expected = c.run().front();
  const Calibration truth = c.scored.calibration;
  Calibration& turned = c.scored.calibration;
  const Transform T_C1C0 = truth.cameras[1].T_C0Ci.inverse();
  turned.cameras = {truth.cameras[1], truth.cameras[0]};
  turned.cameras[0].T_C0Ci = Transform();
  turned.cameras[1].T_C0Ci = T_C1C0;
  turned.imu->T_SC0 = truth.imu->T_SC0 * truth.cameras[1].T_C0Ci;
  turned.imu->time_offsets = {{truth.imu->timeOffset()}, {truth.imu->timeOffset(), true}};
  turned.cameras[1].T_C0Ci_std = turned.imu->T_SC0_std = Vector6d::Constant(1e-3);
  turned.imu->time_offset_std_s = 1e-4;
  const auto score = c.run().front();
  EXPECT_NEAR(score.reprojection.rmse_px, expected.reprojection.rmse_px, 1e-9);
  ASSERT_TRUE(score.camera_imu);
  EXPECT_NEAR(score.camera_imu->rmse_px, expected.camera_imu->rmse_px, 1e-7);
  EXPECT_NEAR(*score.camera_imu_cost, *expected.camera_imu_cost, 1e-6 * *expected.camera_imu_cost);
  const Calibration matched = matchCalibration(turned, "file", c.simulated.session);
  EXPECT_LT(boxminus(matched.imu->T_SC0, truth.imu->T_SC0).norm(), 1e-12);
  EXPECT_EQ(matched.imu->timeOffset(1), truth.imu->timeOffset());
  // Deviations are of what the file's camera 0 was the reference of.
  EXPECT_FALSE(matched.cameras[1].T_C0Ci_std);
  EXPECT_FALSE(matched.imu->T_SC0_std);
  EXPECT_FALSE(matched.imu->time_offset_std_s);
}

TEST(ScoreCalibration, ASecondCameraAloneIsScoredThroughItsOwnPlace) {
  Case c;
  Session& session = c.simulated.session;
  session.cameras.erase(session.cameras.begin());
  Calibration& file = c.scored.calibration;
  const double offset = file.imu->timeOffset();
  file.imu->time_offsets = {{offset + 1}, {offset, true}};  // this session has no cam0
  const auto scores = c.run();
  EXPECT_EQ(scores[0].problem, "");
  EXPECT_EQ(scores[0].entropy_parameters.front(), "cam1.fu");
  EXPECT_NEAR(scores[0].camera_imu.value().rmse_px, kSigma * std::sqrt(2.0), 0.05 * kSigma);
}

std::string refusalOf(const Case& c) {
  try {
    (void)c.run();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ScoreCalibration, RefusesACalibrationOfOtherCameras) {
  Case other;
  other.scored.calibration.cameras[1].intrinsics.resolution = {640, 480};
  EXPECT_THAT(refusalOf(other), HasSubstr("truth.json: cam1 is for 640x480 pixels"));
  Case missing;
  missing.scored.calibration.cameras.pop_back();
  EXPECT_THAT(refusalOf(missing), HasSubstr("truth.json: has no cam1"));
}

TEST(ScoreCalibration, SaysWhyThereIsNoScore) {
  Case c;
  for (CameraStream& camera : c.simulated.session.cameras) {
    for (ImageView& view : camera.views) view.corners.clear();
  }
  const auto scores = c.run();
  ASSERT_EQ(scores.size(), 1u);
  EXPECT_THAT(scores[0].problem, HasSubstr("no corner of the target"));
  EXPECT_EQ(scores[0].reprojection.count, 0u);
}

TEST(ScoreCalibration, ASolutionThatDidNotConvergeHasNoFigures) {
  Case c;
  c.options.camera_imu.max_iterations = 1;
  const CalibrationScore s = c.run().front();
  EXPECT_THAT(s.problem, HasSubstr("poses and biases did not converge in 1 iterations"));
  EXPECT_GT(s.reprojection.count, 0u);
  EXPECT_FALSE(s.camera_imu);
}

TEST(ScoreCalibration, AHeldOutSessionIsMarkedAsSuch) {
  const Case c;
  const CalibrationScore s = scoreHeldOut(c.scored, c.simulated.session, c.options);
  EXPECT_TRUE(s.held_out);
  EXPECT_EQ(s.part, "all");
  EXPECT_EQ(s.reprojection.count, c.run().front().reprojection.count);
}

}  // namespace
}  // namespace plumbline
