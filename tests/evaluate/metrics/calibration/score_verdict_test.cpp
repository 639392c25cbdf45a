// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluate/metrics/calibration/score.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

CalibrationScore score(const std::string& session, const std::string& part, double rmse) {
  CalibrationScore s;
  s.session = session;
  s.part = part;
  s.reprojection.rmse_px = rmse;
  s.reprojection.count = 1000;
  return s;
}

CalibrationRecord record(std::vector<CalibrationScore> scores) {
  CalibrationRecord r;
  r.held = HeldCalibration{"camchain.yaml", std::move(scores)};
  return r;
}

TEST(ScoreVerdict, SaysTheErrorOfEverySessionAndFoldTogether) {
  CalibrationScore own = score("euroc", "all", 0.36), fold = score("euroc", "fold 1 of 2", 9);
  own.camera_imu = ErrorStatistics{};
  own.camera_imu->rmse_px = 0.41;
  CalibrationScore folds = score("euroc", "all 2 folds", 0.37);
  folds.held_out = true;
  const Verdict v = scoreVerdict(record({own, fold, folds}));
  EXPECT_EQ(v.headline,
            "camchain.yaml: 0.36 px RMSE on euroc (0.41 px with the IMU), 0.37 px RMSE in "
            "all 2 folds, held out; only poses are estimated.");
  EXPECT_EQ(v.level, VerdictLevel::kGood);
}

TEST(ScoreVerdict, TheShapeOfTheBoardThatWasNotUsedIsNamedWithItsCure) {
  const Verdict v = scoreVerdict(record({score("euroc", "all", 0.46)}), "cal/target_shape.yaml");
  EXPECT_EQ(v.level, VerdictLevel::kCaution);
  EXPECT_THAT(v.headline, HasSubstr("run again with --target-shape cal/target_shape.yaml"));
  const Finding f = unusedShape("cal/target_shape.yaml");
  EXPECT_THAT(f.evidence, HasSubstr("cal/target_shape.yaml lies beside the calibration"));
  EXPECT_THAT(f.advice, HasSubstr("if the calibration was estimated with that shape"));
}

TEST(ScoreVerdict, WhatCouldNotBeScoredIsSaid) {
  CalibrationScore none = score("other", "all", 0);
  none.reprojection.count = 0;
  none.problem = "no frame's pose is determined";
  const Verdict v = scoreVerdict(record({score("euroc", "all", 0.36), none}));
  EXPECT_EQ(v.level, VerdictLevel::kBad);
  EXPECT_THAT(v.headline, HasSubstr("Score on other, all: no frame's pose is determined"));
}

TEST(ScoreVerdict, HeldOutErrorsAreJudged) {
  CalibrationScore other = score("other", "all", 1.5);
  other.held_out = true;
  EXPECT_EQ(scoreVerdict(record({score("euroc", "all", 0.36), other})).level,
            VerdictLevel::kCaution);
  CalibrationScore fold = score("euroc", "fold 1 of 2", 5);
  fold.held_out = true;  // of the pool of all folds
  CalibrationScore folds = score("euroc", "all 2 folds", 5);
  folds.held_out = true;
  const Verdict v = scoreVerdict(record({score("euroc", "all", 0.36), fold, folds}));
  EXPECT_EQ(v.level, VerdictLevel::kBad);
  ASSERT_EQ(v.findings.size(), 1u);
  EXPECT_EQ(v.findings[0].rule, "Held-out reprojection error on euroc, all 2 folds");
}

TEST(ScoreVerdict, ARecordingThatIsNotHeldOutIsJudgedAndNamed) {
  const Verdict v = scoreVerdict(record({score("euroc", "all", 0.36), score("copy", "all", 3)}));
  ASSERT_EQ(v.findings.size(), 2u);
  EXPECT_THAT(v.findings[0].evidence, HasSubstr("is not held out"));
  EXPECT_EQ(v.findings[1].rule, "Reprojection error on copy, all");
  EXPECT_EQ(v.findings[1].level, VerdictLevel::kBad);
  EXPECT_THAT(v.headline, testing::Not(HasSubstr("held out,")));
}

TEST(ScoreVerdict, ACalibrationThatDoesNotFitTheRecordingIsBad) {
  CalibrationRecord r = record({score("euroc", "all", 3)});
  CameraStageResult stage;
  stage.cameras.resize(1);
  stage.cameras[0].name = "cam0";
  stage.cameras[0].intrinsics.resolution = {752, 480};
  ErrorStatistics errors;
  errors.rmse_px = 3;
  errors.count = 1000;
  stage.summary.per_camera = {errors};
  r.camera = stage;
  const Verdict v = scoreVerdict(r);
  EXPECT_EQ(v.level, VerdictLevel::kBad);
  EXPECT_THAT(v.headline, HasSubstr("Reprojection error of cam0"));
}

TEST(ScoreVerdict, AnExtrinsicThatCouldNotBeTestedIsNotGood) {
  Finding f;
  f.level = VerdictLevel::kCaution;
  EXPECT_EQ(scoreVerdict(record({score("euroc", "all", 0.36)}), "", {{}, {f}}).level,
            VerdictLevel::kCaution);
}

TEST(ScoreVerdict, NamesNoOptionThatTheCommandDoesNotHave) {
  CalibrationRecord r = record({score("euroc", "all", 3)});
  CameraStageResult stage;
  stage.cameras.resize(1);
  ErrorStatistics errors;
  errors.rmse_px = 3;
  errors.count = 1000;
  stage.summary.per_camera = {errors};
  r.camera = stage;
  for (const Finding& f : scoreVerdict(r).findings) {
    EXPECT_THAT(f.advice, testing::Not(HasSubstr("--models")));
  }
}

}  // namespace
}  // namespace plumbline
