// SPDX-License-Identifier: BSD-3-Clause
// What is said of differences, and how grave they are.
#include "evaluate/compare/findings.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "evaluate/compare/compare_calibrations.h"
#include "evaluate/compare/parameters.h"
#include "evaluate/metrics/lists.h"
#include "tests/evaluate/compare/compared_rigs.h"

namespace plumbline {
namespace {

using test::moved;
using test::stereo;

const Finding* find(const std::vector<Finding>& findings, const std::string& start) {
  const auto found = std::find_if(findings.begin(), findings.end(),
                                  [&](const Finding& f) { return f.rule.rfind(start, 0) == 0; });
  return found == findings.end() ? nullptr : &*found;
}

TEST(ComparisonFindings, NameWhatDiffersAndWhichPredictsBetter) {
  Calibration a = stereo(), b = moved();
  a.cameras[0].intrinsics_std = b.cameras[0].intrinsics_std = Eigen::VectorXd::Constant(8, 0.1);
  ComparisonRecord record;
  record.calibrations = {{"a", "", "", a, {}}, {"b", "", "", b, {}}};
  record.parameters = comparedParameters({a, b});
  record.paired = {{"b", "cam0", 100, -0.2, 0.01, 1, 10, 0.0226},
                   {"b", "cam1", 100, 0.019, 0.01, 1, 10, 0.0226}};
  ImageMap map{"cam0", "b - a", "", 1, 3, 3, 752, 480, {4, 1, 1, 1, 0.1, 1, 1, 1, 6}, {}, {}};
  record.differences = {map};
  const auto findings = comparisonFindings(record);
  EXPECT_EQ(find(findings, "Parameters of b")->level, VerdictLevel::kCaution);
  EXPECT_NE(find(findings, "Parameters of b")->evidence.find("cam0.fu (3.5)"), std::string::npos);
  EXPECT_NE(find(findings, "Transforms")->evidence.find("0.5 mm"), std::string::npos);
  EXPECT_EQ(find(findings, "Projection of b")->level, VerdictLevel::kBad);
  EXPECT_NE(find(findings, "Projection of b")->evidence.find("6 px at most, 0.1 px at the centre"),
            std::string::npos);
  EXPECT_EQ(find(findings, "Corners of cam0")->evidence.rfind("b has the lower error", 0), 0u);
  EXPECT_EQ(find(findings, "Corners of cam1")->evidence.rfind("no clear difference", 0), 0u);
}

TEST(ComparisonFindings, CopiesAreNoAgreementOfTwoCalibrations) {
  ComparisonRecord record;
  record.calibrations = {{"a", "", "kalibr", stereo(), {}}, {"b", "", "kalibr", stereo(), {}}};
  record.parameters = comparedParameters({stereo(), stereo()});
  const auto parameters = [&] { return *find(comparisonFindings(record), "Parameters of b"); };
  EXPECT_EQ(parameters().level, VerdictLevel::kCaution);
  EXPECT_NE(parameters().evidence.find("one calibration"), std::string::npos);
  // Exported, it has the same values by right.
  record.calibrations[1].tool = "basalt";
  EXPECT_EQ(parameters().level, VerdictLevel::kGood);
}

TEST(ComparisonFindings, AnImuOnOneSideAloneIsSaid) {
  Calibration cameras_alone = stereo();
  cameras_alone.imu.reset();
  ComparisonRecord record;
  record.calibrations = {{"a", "", "", stereo(), {}}, {"b", "", "", cameras_alone, {}}};
  record.parameters = comparedParameters({stereo(), cameras_alone});
  const auto findings = comparisonFindings(record);
  ASSERT_NE(find(findings, "Models of b"), nullptr);
  EXPECT_EQ(find(findings, "Models of b")->level, VerdictLevel::kCaution);
  EXPECT_EQ(find(findings, "Models of b")->evidence.rfind("only a has T_SC0", 0), 0u);
}

// By the tests of each file on it; equal words for two that are contradicted alike.
TEST(ComparisonFindings, OfTwoThatDifferTheRecordingsContradictionNamesOne) {
  Calibration far = stereo();
  far.imu->T_SC0.t.x() += 0.02;
  ComparisonRecord record;
  record.name = "night";
  record.calibrations = {{"a", "", "", stereo(), {}}, {"b", "", "", far, {}}};
  record.parameters = comparedParameters({stereo(), far});
  record.scores.emplace_back();
  const auto advice = [&] { return find(comparisonFindings(record), "Transforms")->advice; };
  EXPECT_EQ(advice().rfind("night could not test both", 0), 0u) << advice();
  record.calibrations[0].contradicted = false;
  record.calibrations[1].contradicted = false;
  EXPECT_EQ(advice().rfind("night contradicts neither", 0), 0u) << advice();
  record.calibrations[1].contradicted = true;
  EXPECT_EQ(advice().rfind("night contradicts b alone", 0), 0u) << advice();
  record.calibrations[0].contradicted = true;
  EXPECT_EQ(advice().rfind("night contradicts both", 0), 0u) << advice();
}

// A wrong lens is off by thousands of pixels at the border, a foreign rig by decimetres.
TEST(ComparisonFindings, LargeDifferencesHaveNoExponent) {
  ComparisonRecord record;
  Calibration far = stereo();
  far.imu->T_SC0.t.x() += 1.5;
  record.calibrations = {{"a", "", "", stereo(), {}}, {"b", "", "", far, {}}};
  record.parameters = comparedParameters({stereo(), far});
  record.differences = {
      {"cam0", "b - a", "", 1, 3, 3, 752, 480, {4, 1, 1, 1, 99.6, 1, 1, 1, 5738}, {}, {}}};
  const auto findings = comparisonFindings(record);
  EXPECT_NE(find(findings, "Transforms")->evidence.find("T_SC0 1500 mm"), std::string::npos);
  EXPECT_NE(find(findings, "Projection of b")->evidence.find("5738 px at most, 100 px at the"),
            std::string::npos);
  const std::string headline = comparisonHeadline(record);
  EXPECT_NE(headline.find("by up to 5738 px"), std::string::npos) << headline;
  EXPECT_NE(headline.find("by 1500 mm"), std::string::npos) << headline;
}

// A camera's difference at two ranges, another camera's: one cause, one finding with its places.
TEST(ComparisonFindings, ProjectionsOfAPairAreOneFindingWithItsPlaces) {
  ComparisonRecord record;
  record.calibrations = {{"a", "", "", stereo(), {}}, {"b", "", "", moved(), {}}};
  for (const char* camera : {"cam0", "cam1"}) {
    record.differences.push_back(
        {camera, "b - a", "", 1, 3, 3, 752, 480, {4, 1, 1, 1, 0.1, 1, 1, 1, 6}, {}, {}});
  }
  record.paired = {{"b", "cam0", 100, 0.2, 0.01, 1, 10, 0.0226},
                   {"b", "cam1", 100, 0.19, 0.01, 1, 10, 0.0226}};
  const auto findings = comparisonFindings(record);
  const auto projection = [](const Finding& f) { return f.rule.rfind("Projection", 0) == 0; };
  ASSERT_EQ(std::count_if(findings.begin(), findings.end(), projection), 1);
  const Finding& f = *find(findings, "Projection of b");
  EXPECT_NE(f.evidence.find("cam0 at 1 m"), std::string::npos) << f.evidence;
  EXPECT_NE(f.evidence.find("cam1 at 1 m"), std::string::npos) << f.evidence;
  EXPECT_EQ(f.value, 6);
  // Of corners that one of them may have been estimated from nothing follows.
  EXPECT_EQ(f.advice.rfind("a has the lower error on the corners, but", 0), 0u) << f.advice;
  for (const char* label : {"a", "b"}) {
    record.scores.emplace_back();
    record.scores.back().label = label;
    record.scores.back().held_out = true;
  }
  const Finding held_out = *find(comparisonFindings(record), "Projection of b");
  EXPECT_EQ(held_out.advice.rfind("prefer a, which predicts the corners better", 0), 0u)
      << held_out.advice;
  record.paired[1].difference_px2 = -0.19;  // each camera says another: nobody is named
  EXPECT_EQ(find(comparisonFindings(record), "Projection of b")->advice.find("prefer"),
            std::string::npos);
}

TEST(ComparisonFindings, TransformsAndOffsetAreJudgedInTheUnitOfTheirBound) {
  Calibration b = stereo();
  b.imu->T_SC0.t.x() += 9e-3;
  b.imu->time_offsets[0].s += 2e-4;
  ComparisonRecord record;
  record.calibrations = {{"a", "", "", stereo(), {}}, {"b", "", "", b, {}}};
  record.parameters = comparedParameters({stereo(), b});
  const auto findings = comparisonFindings(record);
  const Finding& f = *find(findings, "Transforms");
  EXPECT_EQ(f.level, VerdictLevel::kCaution);
  EXPECT_NEAR(f.value, 9, 1e-9);
  EXPECT_EQ(f.threshold, 5);
  EXPECT_EQ(f.unit, "mm");
  b.imu->T_SC0.t.x() += 20e-3;
  record.parameters = comparedParameters({stereo(), b});
  EXPECT_EQ(find(comparisonFindings(record), "Transforms")->level, VerdictLevel::kBad);
  // As far as the deviations of both explain it, a difference is none.
  for (ComparedParameter& p : record.parameters) {
    if (p.name.starts_with("T_SC0.") && p.difference[1]) p.significance[1] = 2.5;
  }
  const auto explained = comparisonFindings(record);
  EXPECT_EQ(find(explained, "Transforms")->level, VerdictLevel::kGood);
  EXPECT_NE(find(explained, "Transforms")->evidence.find("within the standard deviations"),
            std::string::npos);
}

TEST(ComparisonFindings, TheThresholdIsTheOneThatWasCrossed) {
  Calibration b = stereo();
  b.imu->T_SC0.t.x() += 22e-3;
  ComparisonRecord record;
  record.calibrations = {{"a", "", "", stereo(), {}}, {"b", "", "", b, {}}};
  record.parameters = comparedParameters({stereo(), b});
  record.differences = {
      {"cam0", "b - a", "", 1, 3, 3, 752, 480, {4, 1, 1, 1, 0.1, 1, 1, 1, 6}, {}, {}}};
  const auto findings = comparisonFindings(record);
  EXPECT_EQ(find(findings, "Transforms")->threshold, 20);
  EXPECT_EQ(find(findings, "Projection of b")->threshold, 5);
}

// Each camera's own offset has no deviation; the mean over cameras has.
TEST(ComparisonFindings, OffsetsOfEachCameraCanBeExplained) {
  Calibration a = stereo(), b = stereo();
  b.imu->time_offsets = {{a.imu->timeOffset() + 4e-3}, {a.imu->timeOffset() + 4.1e-3, true}};
  a.imu->time_offset_std_s = b.imu->time_offset_std_s = 2e-3;
  ComparisonRecord record;
  record.calibrations = {{"a", "", "", a, {}}, {"b", "", "", b, {}}};
  record.parameters = comparedParameters({a, b});
  ASSERT_NE(findBy(record.parameters, &ComparedParameter::name, "time_offset.cam1"), nullptr);
  EXPECT_EQ(find(comparisonFindings(record), "Transforms")->level, VerdictLevel::kGood);
}

TEST(ComparisonFindings, WhereNoDifferenceIsDefinedTheProjectionIsNotGood) {
  const double nan = std::nan("");
  ComparisonRecord record;
  record.calibrations = {{"a", "", "", stereo(), {}}, {"b", "", "", stereo(), {}}};
  ImageMap map{"cam0", "b - a", "", 1, 3, 3, 752, 480, {nan, 0, 0, 0, 0, 0, 0, 0, nan}, {}, {}};
  record.differences = {map};
  const auto some = comparisonFindings(record);
  EXPECT_EQ(find(some, "Projection of b")->level, VerdictLevel::kGood);
  EXPECT_NE(find(some, "Projection of b")->evidence.find("undefined on 22 % of the image"),
            std::string::npos);
  // Five of nine: the rest does not speak for the image.
  for (const std::size_t i : {1U, 2U, 3U}) record.differences[0].values[i] = nan;
  EXPECT_EQ(find(comparisonFindings(record), "Projection of b")->level, VerdictLevel::kCaution);
  record.differences[0].values.assign(9, nan);
  EXPECT_EQ(find(comparisonFindings(record), "Projection of b")->level, VerdictLevel::kBad);
}

TEST(ComparisonFindings, AScoreWithoutTheImuIsNotCalledMissing) {
  ComparisonRecord record;
  record.calibrations = {{"a", "", "", stereo(), {}}, {"b", "", "", stereo(), {}}};
  record.name = "euroc";
  CalibrationScore& score = record.scores.emplace_back();
  score.label = "b";
  score.session = "euroc";
  score.per_camera.resize(1);
  score.reprojection.count = 100;
  score.problem = "camera-IMU: no solution";
  EXPECT_EQ(find(comparisonFindings(record), "b on euroc")->evidence, "camera-IMU: no solution");
  EXPECT_NE(comparisonSummary(record).find("camera-IMU: no solution"), std::string::npos);
  EXPECT_EQ(find(comparisonFindings(record), "b on euroc")->level, VerdictLevel::kCaution);
  // Of a calibration that cannot be scored at all the level is that of `evaluate calibration`.
  record.scores[0].reprojection.count = 0;
  EXPECT_EQ(find(comparisonFindings(record), "b on euroc")->level, VerdictLevel::kBad);
}

// In the middle of a letter the table would be no UTF-8.
TEST(ComparisonSummary, CutsALongLabelBetweenItsLetters) {
  ComparisonRecord record;
  std::string letters;
  for (int i = 0; i < 30; ++i) letters += "\u00fc";
  for (const std::string& label : {letters, "b" + letters}) {
    record.calibrations.emplace_back().label = label;
  }
  const std::string table = comparisonSummary(record);
  EXPECT_NE(table.find("..." + letters.substr(0, 42) + " "), std::string::npos) << table;
}

// 4 ms are eight times the offset's bound of caution, and not bad; 22 mm are 4.4 times the lever's,
// and bad: the worst level counts, not the largest multiple.
TEST(ComparisonFindings, TheWorstLevelOfTransformsAndOffsetCounts) {
  Calibration b = stereo();
  b.imu->T_SC0.t.x() += 22e-3;
  b.imu->time_offsets[0].s += 4e-3;
  ComparisonRecord record;
  record.calibrations = {{"a", "", "", stereo(), {}}, {"b", "", "", b, {}}};
  record.parameters = comparedParameters({stereo(), b});
  const auto findings = comparisonFindings(record);
  const Finding& f = *find(findings, "Transforms");
  EXPECT_EQ(f.level, VerdictLevel::kBad);
  EXPECT_NEAR(f.value, 22, 1e-9);
  EXPECT_EQ(f.unit, "mm");
}

}  // namespace
}  // namespace plumbline
