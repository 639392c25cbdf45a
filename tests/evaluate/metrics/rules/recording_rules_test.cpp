// SPDX-License-Identifier: BSD-3-Clause
// What a recording shows of views, image and board.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/evaluate/metrics/verdict_records.h"

namespace plumbline {
namespace {

using test::cameraRecord;
using test::findingOf;
using ::testing::HasSubstr;

// A view of which every corner was rejected tells the camera nothing.
TEST(RecordingRules, ViewsCountWhereCornersWereUsed) {
  CalibrationRecord record = cameraRecord(0.3, 0.8, 24);
  for (CornerResidual& r : record.camera->residuals) r.used = r.frame >= 10;
  const Finding f = findingOf(judge(record), "Views of cam0");
  EXPECT_EQ(f.value, 14);
  EXPECT_EQ(f.level, VerdictLevel::kCaution);
}

// A tenth of the views has to be tilted: three of twenty do, one of twenty does not.
TEST(RecordingRules, ATenthOfTheViewsHasToBeTilted) {
  const auto tiltOf = [](int tilted) {
    CalibrationRecord record = cameraRecord(0.3, 0.1, 20);
    const auto other = cameraRecord(0.3, 0.8, tilted).camera->T_FC0;
    std::copy(other.begin(), other.end(), record.camera->T_FC0.begin() + 7);
    return findingOf(judge(record), "Tilt of the views");
  };
  EXPECT_NEAR(tiltOf(3).value, kDegrees * 0.8, 1e-9);
  EXPECT_EQ(tiltOf(3).level, VerdictLevel::kGood);
  EXPECT_NEAR(tiltOf(1).value, kDegrees * 0.1, 1e-9);
  EXPECT_EQ(tiltOf(1).level, VerdictLevel::kBad);
}

// Some models have parameters before the focal lengths (xi of omni); pixel (0, 0) is the centre of
// the first one, so the middle of 800 pixels is at 399.5.
TEST(RecordingRules, ThePrincipalPointIsTheEndOfWhateverProjection) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  Intrinsics& k = record.camera->cameras[0].intrinsics;
  k.projection_model = ProjectionModel::kOmni;
  const auto off = [&](double u, double v) {
    k.projection = (Eigen::VectorXd(5) << 0.9, 450, 450, u, v).finished();
    return findingOf(judge(record), "Principal point of cam0");
  };
  EXPECT_NEAR(off(399.5, 299.5).value, 0, 1e-12);
  EXPECT_NEAR(off(399.5 - 0.2 * 799, 299.5).value, 0.2, 1e-12);
  const Finding down = off(399.5 + 0.01 * 799, 299.5 + 0.2 * 599);
  EXPECT_NEAR(down.value, 0.2, 1e-12);
  EXPECT_EQ(down.level, VerdictLevel::kCaution);
}

// Corners end well before the right edge; they tell a smaller image only where they begin at the
// left edge, and of the camera that they are of.
TEST(RecordingRules, AnEmptyStripTellsASmallerImageOfItsCameraAlone) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  CameraStageResult& stage = *record.camera;
  stage.cameras.push_back(stage.cameras[0]);
  stage.cameras[1].name = "cam1";
  for (CameraCalibration& camera : stage.cameras) {
    camera.intrinsics.projection = Eigen::Vector4d(450, 450, 350, 300);
  }
  const std::size_t corners = stage.residuals.size();
  for (std::size_t i = 0; i < corners; ++i) {
    CornerResidual r = stage.residuals[i];
    r.camera = 1;
    r.uv.x() -= 45;  // from 5 to 705 px
    stage.residuals.push_back(r);
  }
  const Verdict verdict = judge(record);
  EXPECT_EQ(findingOf(verdict, "Resolution of cam0").value, 0) << "corners begin at 50 px";
  EXPECT_NEAR(findingOf(verdict, "Resolution of cam1").value, (799.0 - 705) / 800, 1e-6);
  EXPECT_EQ(findingOf(verdict, "Resolution of cam1").level, VerdictLevel::kCaution);
}

// docs/target_shape.md: a bent board that was taken as flat is caution, however little it is bent.
TEST(RecordingRules, ABentBoardIsCautionUnlessTheCamerasWereEstimatedWithIt) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  TargetFit& fit = record.camera->target_fit.emplace();
  fit.finding = TargetFinding::kBent;
  const auto found = [&](double bend_m, bool applied) {
    fit.shape.terms.setZero();
    fit.shape.terms(8) = bend_m;
    record.camera->target.terms = TargetTerms::Zero();
    if (applied) record.camera->target.terms = fit.shape.terms;
    return findingOf(judge(record), "Shape of the target");
  };
  EXPECT_EQ(found(5e-4, false).level, VerdictLevel::kCaution);
  EXPECT_THAT(found(5e-4, false).advice, HasSubstr("--target-shape auto"));
  EXPECT_EQ(found(5e-4, true).level, VerdictLevel::kGood);
  EXPECT_NEAR(found(5e-4, true).value, 0.5, 1e-12) << "in mm";
  EXPECT_THAT(found(5e-4, true).evidence, HasSubstr("0.50 mm in height"));
  EXPECT_EQ(found(5e-3, true).level, VerdictLevel::kCaution);
  EXPECT_EQ(found(5e-2, false).level, VerdictLevel::kBad);
}

}  // namespace
}  // namespace plumbline
