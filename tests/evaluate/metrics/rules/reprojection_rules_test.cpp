// SPDX-License-Identifier: BSD-3-Clause
// What the corners' errors say: of which camera, where in the image, and which part of them is the
// model's.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/evaluate/metrics/verdict_records.h"

namespace plumbline {
namespace {

using test::cameraRecord;
using test::findingOf;
using ::testing::HasSubstr;

// Two cameras with the same corners. From 3 errors of (3, 4) px in one region the second has a
// systematic error of 5 px there, and the first has none.
TEST(ReprojectionRules, ASystematicErrorIsOfItsCameraAndItsPlace) {
  CalibrationRecord record = cameraRecord(0.1, 0.8, 120);
  CameraStageResult& stage = *record.camera;
  stage.cameras.push_back(stage.cameras[0]);
  stage.cameras[1].name = "cam1";
  stage.summary.per_camera.push_back(stage.summary.per_camera[0]);
  const std::size_t corners = stage.residuals.size();
  for (std::size_t i = 0; i < corners; ++i) {
    CornerResidual r = stage.residuals[i];
    r.camera = 1;
    // The last column of the image, its third row.
    if (r.uv.x() > 700 && r.uv.y() > 200 && r.uv.y() < 300) r.error = {3, 4};
    stage.residuals.push_back(r);
  }
  const Verdict verdict = judge(record);
  EXPECT_EQ(findingOf(verdict, "Systematic error of cam0 (cameras)").level, VerdictLevel::kGood);
  const Finding f = findingOf(verdict, "Systematic error of cam1 (cameras)");
  EXPECT_NEAR(f.value, 5, 1e-6);
  EXPECT_EQ(f.level, VerdictLevel::kCaution);
  EXPECT_THAT(f.evidence, HasSubstr("around pixel (750, 250)"));
}

// The error per axis is hypot(noise, systematic part): of 1.25 px with 1 px of noise 0.75 px
// remain, which is 36 % of the squared error.
TEST(ReprojectionRules, TheBiasIsTheRootOfTheSharedSquaredError) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  record.camera->bias = {{"cam0", 1 - 1 / (1.25 * 1.25), 1.0, 1.25, 100}};
  const Finding f = findingOf(judge(record), "Bias of cam0");
  EXPECT_NEAR(f.value, 0.75, 1e-12);
  EXPECT_EQ(f.level, VerdictLevel::kCaution);
  EXPECT_THAT(f.evidence, HasSubstr("36 % of the squared error"));
  record.camera->bias[0].patches = 0;
  for (const Finding& other : judge(record).findings) EXPECT_NE(other.rule, "Bias of cam0");
}

TEST(ReprojectionRules, CornersOfFramesWithoutAPoseAreAShareOfThoseOffered) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);  // 1920 corners
  record.camera->summary.corners_offered = 2400;
  const Finding f = findingOf(judge(record), "Unused frames (cameras)");
  EXPECT_DOUBLE_EQ(f.value, 0.2);
  EXPECT_EQ(f.level, VerdictLevel::kCaution);
  // A selection of views leaves out frames on purpose.
  record.assumptions.views_selected = true;
  for (const Finding& other : judge(record).findings) {
    EXPECT_NE(other.rule, "Unused frames (cameras)");
  }
}

}  // namespace
}  // namespace plumbline
