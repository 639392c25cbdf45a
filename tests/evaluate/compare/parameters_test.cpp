// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/compare/parameters.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "calibrator/simulate/simulate_session.h"
#include "evaluate/compare/compare_calibrations.h"
#include "evaluate/compare/findings.h"
#include "tests/datasets/calibration/kalibr_texts.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

Calibration stereo() {
  Calibration c;
  for (int i = 0; i < 2; ++i) {
    CameraCalibration camera;
    camera.name = "cam" + std::to_string(i);
    camera.intrinsics.resolution = {752, 480};
    camera.intrinsics.projection = Eigen::Vector4d(458, 457, 367, 248);
    camera.intrinsics.distortion = Eigen::Vector4d(-0.28, 0.07, 2e-4, 1e-5);
    c.cameras.push_back(camera);
  }
  c.cameras[1].T_C0Ci = Transform(expSO3({0.01, -0.02, 0.003}), {0.11, 0.001, -0.002});
  c.imu.emplace();
  c.imu->T_SC0 = Transform(expSO3({0.02, -0.01, 1.55}), {-0.02, -0.065, 0.01});
  c.imu->time_offsets = {{1e-3}};
  return c;
}

const ComparedParameter& row(const std::vector<ComparedParameter>& rows, const std::string& name) {
  const auto found = std::find_if(rows.begin(), rows.end(),
                                  [&](const ComparedParameter& r) { return r.name == name; });
  EXPECT_NE(found, rows.end()) << name;
  return *found;
}

TEST(ComparedParameters, TheSameCalibrationHasNoDifference) {
  for (const ComparedParameter& r : comparedParameters({stereo(), stereo()})) {
    ASSERT_EQ(r.values.size(), 2u);
    EXPECT_FALSE(r.difference[0].has_value());
    ASSERT_TRUE(r.difference[1].has_value()) << r.name;
    EXPECT_LT(std::abs(*r.difference[1]), 1e-15) << r.name;  // Log(R Rt) rounds
  }
}

Calibration moved() {
  Calibration c = stereo();
  c.cameras[0].intrinsics.projection[0] += 0.5;
  c.cameras[1].T_C0Ci.t += Eigen::Vector3d(3e-4, 0, 4e-4);
  c.imu->T_SC0.R = expSO3({0, 0, 1e-3}) * c.imu->T_SC0.R;
  c.imu->time_offsets[0].s -= 2e-4;
  return c;
}

TEST(ComparedParameters, DifferencesAreThoseThatWereMade) {
  const auto rows = comparedParameters({stereo(), moved()});
  EXPECT_NEAR(*row(rows, "cam0.fu").difference[1], 0.5, 1e-12);
  EXPECT_NEAR(*row(rows, "T_C0C1.tz").difference[1], 4e-4, 1e-15);
  EXPECT_NEAR(*row(rows, "T_C0C1.lever").difference[1], 5e-4, 1e-12);
  EXPECT_NEAR(*row(rows, "T_C0C1.angle").difference[1], 0, 1e-12);
  EXPECT_NEAR(*row(rows, "T_SC0.rz").difference[1], 1e-3, 1e-12);
  EXPECT_NEAR(*row(rows, "T_SC0.angle").difference[1], 1e-3, 1e-12);
  EXPECT_NEAR(*row(rows, "time_offset").difference[1], -2e-4, 1e-15);
}

TEST(ComparedParameters, TheOrderOnlyFlipsSigns) {
  const auto forth = comparedParameters({stereo(), moved()});
  const auto back = comparedParameters({moved(), stereo()});
  ASSERT_EQ(forth.size(), back.size());
  for (std::size_t i = 0; i < forth.size(); ++i) {
    const bool norm = forth[i].name.ends_with(".angle") || forth[i].name.ends_with(".lever");
    EXPECT_EQ(forth[i].name, back[i].name);
    EXPECT_NEAR(*forth[i].difference[1], (norm ? 1 : -1) * *back[i].difference[1], 1e-15)
        << forth[i].name;
  }
}

TEST(ComparedParameters, CamerasHaveTheNamesThatAllCalibrationsGiveThem) {
  Calibration one = stereo(), other = moved();
  one.cameras = {one.cameras[1]};
  other.cameras = {other.cameras[1]};
  EXPECT_EQ(comparedParameters({one, other})[0].name, "cam1.fu");
  other.cameras[0].name = "right";  // of another file: only the place is common
  EXPECT_EQ(comparedParameters({one, other})[0].name, "cam0.fu");
}

TEST(ComparedParameters, CamerasHaveTheirNamesAlsoWhereOneCalibrationHasNotAll) {
  Calibration a = stereo(), b = stereo();
  a.cameras[1].name = "cam2";
  b.cameras.pop_back();
  a.imu->time_offsets = {{1e-3}, {3e-3, true}};
  const auto rows = comparedParameters({a, b});
  const auto has = [&](const std::string& name) {
    return std::any_of(rows.begin(), rows.end(),
                       [&](const ComparedParameter& r) { return r.name == name; });
  };
  EXPECT_TRUE(has("cam2.fu"));
  EXPECT_TRUE(has("time_offset.cam2"));
}

TEST(ComparedParameters, SignificanceNeedsBothDeviations) {
  Calibration a = stereo(), b = moved();
  a.cameras[0].intrinsics_std = Eigen::VectorXd::Constant(8, 0.3);
  EXPECT_FALSE(row(comparedParameters({a, b}), "cam0.fu").significance[1].has_value());
  b.cameras[0].intrinsics_std = Eigen::VectorXd::Constant(8, 0.4);
  EXPECT_NEAR(*row(comparedParameters({a, b}), "cam0.fu").significance[1], 0.5 / 0.5, 1e-12);
}

// Significance is a size: it has no sign. From two deviations on a difference is notable, and from
// three on it is named.
TEST(ComparedParameters, SignificanceIsTheSameInEitherDirection) {
  Calibration a = stereo(), b = stereo();
  a.cameras[0].intrinsics_std = Eigen::VectorXd::Constant(8, 0.3);
  b.cameras[0].intrinsics_std = Eigen::VectorXd::Constant(8, 0.4);
  for (const double change : {1.75, -1.75}) {
    b.cameras[0].intrinsics.projection[0] = a.cameras[0].intrinsics.projection[0] + change;
    const auto fu = row(comparedParameters({a, b}), "cam0.fu");
    EXPECT_NEAR(*fu.significance[1], 3.5, 1e-12) << change;
    EXPECT_EQ(fu.levels[1], VerdictLevel::kBad) << change;
  }
  const ComparisonThresholds thresholds;
  EXPECT_EQ(thresholds.levelOf(1.99), VerdictLevel::kGood);
  EXPECT_EQ(thresholds.levelOf(2), VerdictLevel::kCaution);
  EXPECT_EQ(thresholds.levelOf(2.99), VerdictLevel::kCaution);
  EXPECT_EQ(thresholds.levelOf(3), VerdictLevel::kBad);
}

// A file with one offset for all cameras has it for those that it has, and no other.
TEST(ComparedParameters, ACameraThatAFileLacksHasNoOffsetThere) {
  Calibration b = stereo();
  b.imu->time_offsets = {{1e-3}, {3e-3, true}};
  Calibration mono = stereo();
  mono.cameras.resize(1);
  const auto rows = comparedParameters({b, mono});
  EXPECT_TRUE(row(rows, "time_offset.cam0").values[1].has_value());
  EXPECT_FALSE(row(rows, "time_offset.cam1").values[1].has_value());
  // The common one is the mean over cameras, in summaries as well.
  EXPECT_NEAR(*row(rows, "time_offset").values[0], 2e-3, 1e-15);
  EXPECT_NEAR(offsetSummary("b", b).time_offset_s.value(), 2e-3, 1e-15);
  EXPECT_EQ(offsetSummary("b", b).per_camera_s.size(), 2U);
  EXPECT_TRUE(offsetSummary("mono", mono).per_camera_s.empty());
}

TEST(ComparedParameters, AnotherModelHasValuesButNoDifference) {
  Calibration b = stereo();
  b.cameras[1].intrinsics.distortion_model = DistortionModel::kFov;
  b.cameras[1].intrinsics.distortion = Eigen::VectorXd::Constant(1, 0.9);
  const auto rows = comparedParameters({stereo(), b});
  EXPECT_TRUE(row(rows, "cam1.fu").values[1].has_value());
  EXPECT_FALSE(row(rows, "cam1.fu").difference[1].has_value());
  EXPECT_FALSE(row(rows, "cam1.k1").values[1].has_value());
  EXPECT_FALSE(row(rows, "cam1.w").values[0].has_value());
  EXPECT_TRUE(row(rows, "cam0.fu").difference[1].has_value());
}

TEST(ComparedParameters, OffsetsOfEachCameraAreMeantTogether) {
  Calibration b = stereo();
  b.imu->time_offsets = {{1e-3}, {3e-3, true}};
  const auto rows = comparedParameters({stereo(), b});
  EXPECT_NEAR(*row(rows, "time_offset").difference[1], 1e-3, 1e-15);
  EXPECT_NEAR(*row(rows, "time_offset.cam1").difference[1], 2e-3, 1e-15);
  EXPECT_NEAR(*row(rows, "time_offset.cam0").difference[1], 0, 1e-15);
  b.imu.reset();
  const auto without = comparedParameters({stereo(), b});
  EXPECT_FALSE(row(without, "T_SC0.tx").difference[1].has_value());
  EXPECT_FALSE(row(without, "T_SC0.angle").difference[1].has_value());
}

TEST(ComparedParameters, AnOffsetThatAFileDoesNotStateHasNoDifference) {
  for (const std::size_t unknown : {0U, 1U}) {
    Calibration a = stereo(), b = moved();
    a.imu->time_offset_std_s = b.imu->time_offset_std_s = 1e-5;
    auto rows = comparedParameters({a, b});
    EXPECT_TRUE(row(rows, "time_offset").significance[1].has_value());
    removeTimeOffset(unknown, rows);
    EXPECT_FALSE(row(rows, "time_offset").values[unknown].has_value());
    EXPECT_TRUE(row(rows, "time_offset").values[1 - unknown].has_value());
    EXPECT_FALSE(row(rows, "time_offset").difference[1].has_value());
    EXPECT_FALSE(row(rows, "time_offset").significance[1].has_value());
    EXPECT_TRUE(row(rows, "T_SC0.rz").difference[1].has_value());
  }
}

CameraStageResult errorsOf(const std::vector<float>& per_view) {
  CameraStageResult result;
  result.cameras = stereo().cameras;
  for (std::size_t f = 0; f < per_view.size(); ++f) {
    result.frames.push_back({static_cast<TimeNs>(f), {static_cast<int>(f), -1}});
    for (int id = 0; id < 2; ++id) {
      CornerResidual r;
      r.frame = static_cast<int>(f);
      r.corner_id = id;
      r.error = Eigen::Vector2f(per_view[f], 0);
      result.residuals.push_back(r);
    }
  }
  return result;
}

// 50 views, of whose squared errors those of a block of ten are alike: 4, 0, 3, -1 and 9 more.
TEST(PairedPrediction, MeanAndIntervalAreOfBlocksOfViews) {
  std::vector<float> first, other;
  for (const float difference : {4, 0, 3, -1, 9}) {
    first.insert(first.end(), 10, 2);
    other.insert(other.end(), 10, std::sqrt(4 + difference));
  }
  const auto paired = pairedPredictions(errorsOf(first), errorsOf(other), "b");
  ASSERT_EQ(paired.size(), 1u);  // the second camera saw nothing
  EXPECT_EQ(paired[0].views, 50);
  EXPECT_EQ(paired[0].blocks, 5);
  EXPECT_NEAR(paired[0].difference_px2, 3, 1e-6);
  EXPECT_NEAR(paired[0].first_px2, 4, 1e-9);
  // Squares of the deviations from 3: 1, 9, 0, 16, 36.
  EXPECT_NEAR(paired[0].std_px2, std::sqrt(62.0 / 4 / 5), 1e-6);
  EXPECT_NEAR(paired[0].half_px2, 2.776445 * std::sqrt(62.0 / 4 / 5), 1e-5);
  EXPECT_FALSE(paired[0].isClear());  // it would be by the normal distribution's 1.96
}

// Streams need not begin together: a view is known by its own place in its camera's stream.
TEST(PairedPrediction, ViewsOfTheSecondCameraArePairedByTheirOwnIndex) {
  CameraStageResult first = errorsOf({1, 2, 3}), other = errorsOf({2, 2, 2});
  for (CameraStageResult* result : {&first, &other}) {
    for (CornerResidual& r : result->residuals) r.camera = 1;
  }
  // `other` lacks the frame that `first` begins with, and camera 0's views count otherwise.
  for (int f = 0; f < 3; ++f) {
    first.frames[static_cast<std::size_t>(f)].view = {7 - f, f};
    other.frames[static_cast<std::size_t>(f)].view = {7 - f, f + 1};
  }
  const auto paired = pairedPredictions(first, other, "b");
  ASSERT_EQ(paired.size(), 1U);
  EXPECT_EQ(paired[0].camera, "cam1");
  EXPECT_EQ(paired[0].views, 2);
  EXPECT_NEAR(paired[0].first_px2, (4.0 + 9) / 2, 1e-9);
}

TEST(PairedPrediction, OfFewBlocksThereIsNoInterval) {
  const auto paired = pairedPredictions(errorsOf({1, 2, 3}), errorsOf({2, 2, 2}), "b");
  ASSERT_EQ(paired.size(), 1u);
  EXPECT_EQ(paired[0].views, 3);
  // Squares 4-1, 4-4, 4-9.
  EXPECT_NEAR(paired[0].difference_px2, -2.0 / 3, 1e-9);
  EXPECT_NEAR(paired[0].first_px2, (1.0 + 4 + 9) / 3, 1e-9);
  EXPECT_EQ(paired[0].std_px2, 0);
  EXPECT_FALSE(paired[0].isClear());
}

TEST(PairedPrediction, OnlyViewsUnderBothCount) {
  CameraStageResult other = errorsOf({1, 1, 1});
  for (CornerResidual& r : other.residuals) r.used = r.frame != 0;
  const auto paired = pairedPredictions(errorsOf({9, 1, 1}), other, "b");
  ASSERT_EQ(paired.size(), 1u);
  EXPECT_EQ(paired[0].views, 2);
  EXPECT_EQ(paired[0].difference_px2, 0);
}

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
  EXPECT_EQ(find(findings, "Corners of cam0")->evidence.rfind("b is better", 0), 0u);
  EXPECT_EQ(find(findings, "Corners of cam1")->evidence.rfind("no clear difference", 0), 0u);
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
  EXPECT_EQ(f.advice.rfind("a predicts the corners better, but", 0), 0u) << f.advice;
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
  ASSERT_NE(comparedParameter(record, "time_offset.cam1"), nullptr);
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

TEST(DifferenceMaps, WithoutRaysUnderBothTheMapIsUndefined) {
  Calibration blind = stereo();
  for (CameraCalibration& camera : blind.cameras) {
    Intrinsics& k = camera.intrinsics;
    k.projection_model = ProjectionModel::kEucm;
    k.distortion_model = DistortionModel::kNone;
    // Rays within half a pixel of the principal point, which is none of the grid.
    k.projection.resize(6);
    k.projection << 1, 1e6, 458, 457, 367, 248;
    k.distortion.resize(0);
  }
  const MapOptions options;
  const auto maps =
      differenceMaps({"a", "", "", stereo(), {}}, {"b", "", "", blind, {}}, {}, options);
  ASSERT_EQ(maps.size(), 2 * options.ranges_m.size());
  for (const ImageMap& map : maps) {
    EXPECT_EQ(extremesOf(map).undefined, 1);
    EXPECT_NE(map.method.find("fewer than three pixels have a ray under both"), std::string::npos);
  }
}

// Rays are there: the request leaves them out.
TEST(DifferenceMaps, AFocusWithoutPointsOfTheGridIsRefused) {
  const ComparedCalibration a{"a", "", "", stereo(), {}}, b{"b", "", "", stereo(), {}};
  MapOptions narrow, coarse;
  narrow.focus_radius_px = 20;
  coarse.grid = {5, 3};
  for (const MapOptions& options : {narrow, coarse}) {
    EXPECT_THROW(differenceMaps(a, b, {}, options), InputError);
    EXPECT_THROW(options.checkFocus({752, 480}), InputError);
  }
  // Both ways out.
  coarse.focus_radius_px = 300;
  EXPECT_EQ(differenceMaps(a, b, {}, coarse).size(), 4u);
  narrow.grid = {101, 71};
  EXPECT_EQ(differenceMaps(a, b, {}, narrow).size(), 4u);
}

TEST(DifferenceMaps, DeviationsThatGiveNoWeightsLeaveTheFocus) {
  const ComparedCalibration a{"a", "", "", stereo(), {}}, b{"b", "", "", stereo(), {}};
  MapOptions options;
  options.ranges_m = {1};
  std::vector<ImageMap> uncertainties;
  for (const char* label : {"a", "b"}) {
    for (const CameraCalibration& camera : stereo().cameras) {
      uncertainties.push_back(imageMapOf(camera, label, 1, options.grid));
      uncertainties.back().values.assign(static_cast<std::size_t>(options.grid.size()), 0);
    }
  }
  const auto maps = differenceMaps(a, b, uncertainties, options);
  ASSERT_EQ(maps.size(), 2u);
  for (const ImageMap& map : maps) {
    EXPECT_EQ(map.method, "fit over the focus region");
    EXPECT_EQ(extremesOf(map).undefined, 0);
  }
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

TEST(OwnEstimateOfTheSession, AStageThatDidNotConvergeIsNoWitness) {
  SimulationOptions simulation;
  simulation.duration_s = 6;
  simulation.camera_rate_hz = 5;
  const SimulatedSession simulated = simulateSession(simulatedRig("euroc"), simulation);
  ScoreOptions options;
  options.camera_imu.max_iterations = 1;
  const SessionEstimate own =
      sessionEstimate(simulated.session, std::vector<Calibration>{simulated.truth}, options,
                      TargetMode::kGiven, {});
  EXPECT_NE(own.problem.find("did not converge"), std::string::npos) << own.problem;
  EXPECT_EQ(own.calibration.cameras.size(), 2U);
  EXPECT_FALSE(own.calibration.imu);
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

TEST(ReadCompared, AMissingTimeShiftIsUnknown) {
  const TemporaryFolder folder;
  std::string text = kCamchainImuYaml;
  const std::vector<std::string> with = {folder.write("with.yaml", text)};
  EXPECT_TRUE(readCompared(with, {})[0].states_offset);
  for (std::size_t at = text.find("  timeshift_cam_imu:"); at != std::string::npos;
       at = text.find("  timeshift_cam_imu:")) {
    text.erase(at, text.find('\n', at) + 1 - at);
  }
  const TemporaryFolder other;
  const auto without = readCompared({other.write("without.yaml", text)}, {});
  EXPECT_FALSE(without[0].states_offset);
  ASSERT_EQ(without[0].remarks.size(), 1U);
  EXPECT_EQ(without[0].remarks[0].rule, "Time offset");
}

TEST(ReadCompared, ScaleAndMisalignmentOfKalibrsImuAreToldOf) {
  const TemporaryFolder folder;
  const std::vector<std::string> paths = {folder.write("camchain.yaml", kCamchainImuYaml)};
  const std::string gyro =
      "  gyroscopes:\n    M:\n    - [1.01, 0.0, 0.0]\n    - [0.0, 1.0, 0.0]\n"
      "    - [0.0, 0.0, 0.99]\n";
  folder.write("imu.yaml", kImuYaml + gyro);
  const auto distorted = readCompared(paths, {});
  ASSERT_EQ(distorted[0].remarks.size(), 1U);
  EXPECT_EQ(distorted[0].remarks[0].level, VerdictLevel::kCaution);
  folder.write("imu.yaml", kImuYaml);
  EXPECT_TRUE(readCompared(paths, {})[0].remarks.empty());
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
