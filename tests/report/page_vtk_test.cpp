// SPDX-License-Identifier: BSD-3-Clause
// The calibration page: complete, self-contained, the same for the same record, and able to be made
// again from the store.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "report/html/calibration/sections.h"
#include "report/html/page.h"
#include "report/html/pages.h"
#include "report/html/scene.h"
#include "report/html/section.h"
#include "report/html/text.h"
#include "report/plots/svg.h"
#include "report/store/store.h"
#include "tests/report/markup.h"
#include "tests/report/synthetic_record.h"

namespace plumbline {
namespace {

using test::syntheticRecord;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

bool hasSection(const std::string& page, const std::string& id) {
  return page.find("<section id=\"" + id + "\"") != std::string::npos &&
         page.find("<a href=\"#" + id + "\"") != std::string::npos;
}

TEST(CalibrationPage, HasEverySectionAndAnEntryForIt) {
  const std::string page = renderCalibrationPage(syntheticRecord());
  for (const char* id :
       {"key-figures", "scene", "parameters", "time-offset", "correlations", "reprojection-camera",
        "reprojection-camera-imu", "views", "coverage", "imu-readings", "imu-residuals", "biases",
        "sample-intervals", "projection-uncertainty", "provenance"}) {
    EXPECT_TRUE(hasSection(page, id)) << id;
  }
  EXPECT_THAT(page, HasSubstr("class=\"verdict caution\""));
  EXPECT_THAT(page, HasSubstr("Raise the gyroscope"));
  EXPECT_THAT(page, HasSubstr("sha256:0f3a9c"));
}

TEST(CalibrationPage, LeavesOutWhatACameraCalibrationHasNot) {
  const std::string page = renderCalibrationPage(syntheticRecord({.camera_imu = false}));
  for (const char* id : {"time-offset", "reprojection-camera-imu", "imu-residuals", "biases"}) {
    EXPECT_FALSE(hasSection(page, id)) << id;
  }
  EXPECT_TRUE(hasSection(page, "reprojection-camera"));
  EXPECT_THAT(page, Not(HasSubstr("data-layer=\"gravity\"")));
}

TEST(CalibrationPage, ShowsGivenCamerasWithoutACameraStage) {
  CalibrationRecord record = syntheticRecord();
  record.camera.reset();
  record.camera_resample.reset();
  const std::string page = renderCalibrationPage(record);
  EXPECT_FALSE(hasSection(page, "reprojection-camera"));
  EXPECT_TRUE(hasSection(page, "reprojection-camera-imu"));
  EXPECT_TRUE(hasSection(page, "coverage"));
}

TEST(CalibrationPage, ACorrelationThatRoundsToZeroHasNoSign) {
  CalibrationRecord record = syntheticRecord();
  Eigen::MatrixXd& covariance = record.camera_imu->summary.covariance.matrix;
  covariance.setIdentity();
  covariance(0, 1) = covariance(1, 0) = -0.004;
  covariance(0, 2) = covariance(2, 0) = -0.006;
  EXPECT_THAT(renderCalibrationPage(record),
              AllOf(HasSubstr(">-.01</"), HasSubstr(">.00</"), Not(HasSubstr(">-.00</"))));
}

TEST(CalibrationPage, SurvivesARecordWithoutAnyStage) {
  CalibrationRecord record;
  record.name = "empty";
  const std::string page = renderCalibrationPage(record);
  EXPECT_TRUE(hasSection(page, "provenance"));
  EXPECT_FALSE(hasSection(page, "correlations"));
  EXPECT_THAT(page, Not(HasSubstr("rules are met"))) << "there are none";
}

// Card, table of tools and table of parameters state one deviation of the time offset.
TEST(CalibrationPage, ShowsTheRobustDeviationOfTheOffsetEverywhere) {
  CalibrationRecord record = syntheticRecord();
  StageSummary& summary = record.camera_imu->summary;
  const auto n = static_cast<Eigen::Index>(summary.covariance.names.size());
  summary.robust_std = Eigen::VectorXd::Constant(n, 0.0123);
  EXPECT_EQ(shownOffsetStd(record), 0.0123);
  const auto cards = html_internal::keyFigures(record);
  EXPECT_TRUE(std::any_of(cards.begin(), cards.end(), [](const html_internal::Card& card) {
    return card.label == "Time offset" && card.note == "std 12 ms";
  }));
  EXPECT_THAT(renderCalibrationPage(record), HasSubstr("std 12 ms</td>"));
}

TEST(CalibrationPage, SaysHowFarTheOffsetsOfOtherCamerasAre) {
  CalibrationRecord record = syntheticRecord();
  EXPECT_THAT(renderCalibrationPage(record), Not(HasSubstr("not synchronised")));
  record.camera_imu->imu.time_offsets = {{0.001}, {0.005, true}};
  EXPECT_THAT(renderCalibrationPage(record), HasSubstr("add 4 ms to the image stamps of cam1"));
}

TEST(CalibrationPage, NamesTheGapsOfTheStreams) {
  const CalibrationRecord record = syntheticRecord();
  const std::string page = renderCalibrationPage(record);
  const SampleGap& gap = record.sample_intervals.at(2).gaps.at(0);
  const std::string row = page.substr(page.find("The longest gaps"));
  EXPECT_THAT(row.substr(0, row.find("</table>")), HasSubstr(std::to_string(gap.t)));
}

// One colour map for a view's error: frusta, their legend and the lines of the plots.
TEST(CalibrationPage, TheFrustaHaveTheColoursOfTheLegend) {
  const CalibrationRecord record = syntheticRecord();
  const auto css = [](double unit) {
    const Colour c = internal::errorColour(unit);
    return fmt::format("#{:02x}{:02x}{:02x}", c.red, c.green, c.blue);
  };
  const std::string page = renderCalibrationPage(record);
  const std::string legend = page.substr(page.find("data-legend=\"rmse\""), 200);
  EXPECT_THAT(legend, AllOf(HasSubstr("(90deg, " + css(0)), HasSubstr(css(1) + ")")));
  std::set<std::string> seen;
  for (const html_internal::SceneObject& object : html_internal::buildScene(record).objects) {
    if (!object.colours.contains("rmse")) continue;
    for (const Colour& c : object.colours.at("rmse")) {
      seen.insert(fmt::format("#{:02x}{:02x}{:02x}", c.red, c.green, c.blue));
    }
  }
  EXPECT_TRUE(seen.contains(css(0)) && seen.contains(css(1))) << "the least and the largest error";
}

// One clock for all plots: a stage whose first frame is later starts later in them.
TEST(CalibrationPage, CountsTheTimeOfAllPlotsFromOneFrame) {
  CalibrationRecord record = syntheticRecord();
  CameraImuStageResult& stage = *record.camera_imu;
  stage.frames.erase(stage.frames.begin(), stage.frames.begin() + 20);  // one second
  stage.states.erase(stage.states.begin(), stage.states.begin() + 20);
  std::erase_if(stage.residuals, [](const CornerResidual& r) { return r.frame < 20; });
  for (CornerResidual& r : stage.residuals) r.frame -= 20;
  EXPECT_EQ(html_internal::timeOrigin(record), record.camera->frames.front().t);
  const auto seconds = html_internal::frameSeconds(html_internal::cameraImuView(record));
  EXPECT_NEAR(seconds.front(), 1.0, 1e-9);
  EXPECT_EQ(html_internal::frameSeconds(html_internal::cameraView(record)).front(), 0);
}

TEST(CalibrationPage, ShowsTheImagesThatTheRecordHas) {
  const std::string page = renderCalibrationPage(syntheticRecord());
  const std::string jpeg = html_internal::base64(syntheticRecord().view_images.at(0).jpeg);
  EXPECT_THAT(page, HasSubstr(jpeg));
  EXPECT_THAT(page, HasSubstr("data-image"));
  const std::string without = renderCalibrationPage(syntheticRecord({.images = false}));
  EXPECT_THAT(without, Not(HasSubstr("data-image=")));
}

TEST(CalibrationPage, MapsTheProjectionUncertaintyWhereItIsKnown) {
  CalibrationRecord record = syntheticRecord();
  const std::string page = renderCalibrationPage(record);
  EXPECT_THAT(page, HasSubstr("cam0: at infinity"));
  EXPECT_THAT(page, HasSubstr("largest 0.17 px"));
  record.projection_uncertainty.clear();
  EXPECT_FALSE(hasSection(renderCalibrationPage(record), "projection-uncertainty"));
}

html_internal::Section viewsPart(const CalibrationRecord& record) {
  const html_internal::StageView stage = html_internal::cameraView(record);
  return html_internal::viewsSection(stage, record.camera->T_FC0, {});
}

/// Rows [camera, frame, RMSE, largest, used, first corner or -1, corners].
nlohmann::json viewRows(const html_internal::Section& section) {
  const std::string& html = section.blocks.at(0).html;
  const std::string start = "class=\"views-data\">";
  const std::size_t begin = html.find(start) + start.size();
  return nlohmann::json::parse(html.substr(begin, html.find("</script>") - begin))["views"];
}

/// Of each camera's views those that are carried, beside the worst hundred of all.
std::vector<int> carriedOf(const CalibrationRecord& record) {
  std::vector<int> carried(record.camera->cameras.size(), 0);
  for (const auto& row : viewRows(viewsPart(record))) {
    if (row[5] != -1) ++carried[row[0].get<std::size_t>()];
  }
  return carried;
}

TEST(CalibrationPage, OfManyCornersThoseOfAllCamerasAreCarried) {
  CalibrationRecord record = syntheticRecord({.frames = 400});
  std::vector<CornerResidual>& residuals = record.camera->residuals;
  const std::vector<CornerResidual> once = residuals;
  while (residuals.size() <= 100'000) residuals.insert(residuals.end(), once.begin(), once.end());
  const auto together = carriedOf(record);
  EXPECT_LT(together[0] + together[1], 600);
  EXPECT_LT(std::abs(together[0] - together[1]), 100);
  // Cameras that are not exposed together, whose frames alternate.
  std::erase_if(residuals, [](const CornerResidual& r) { return r.frame % 2 != r.camera; });
  const std::vector<CornerResidual> half = residuals;
  while (residuals.size() <= 100'000) residuals.insert(residuals.end(), half.begin(), half.end());
  const auto alternating = carriedOf(record);
  EXPECT_GT(alternating[1], alternating[0] / 2);
  EXPECT_LT(alternating[1], 2 * alternating[0]);
}

TEST(CalibrationPage, AViewWhoseCornersWereAllRejectedHasNoError) {
  CalibrationRecord record = syntheticRecord({.frames = 4});
  for (CornerResidual& r : record.camera->residuals) {
    if (r.frame == 1 && r.camera == 0) r.used = false;
  }
  const html_internal::Section section = viewsPart(record);
  const auto rows = viewRows(section);
  ASSERT_EQ(rows.size(), 8U);
  for (const auto& row : rows) {
    const bool rejected = row[0] == 0 && row[1] == 1;
    EXPECT_EQ(row[2].is_null(), rejected) << row;
    EXPECT_EQ(row[3].is_null(), rejected) << row;
  }
  // Nor is it the best one: it stands behind all others.
  const auto& worst = section.blocks.at(1).table->rows;
  ASSERT_EQ(worst.size(), 8U);
  EXPECT_EQ(worst.back()[2].text, html_internal::kDash);
  EXPECT_EQ(worst.back()[3].text, html_internal::kDash);
}

TEST(CalibrationPage, ListsTheRejectedCorners) {
  CalibrationRecord record = syntheticRecord();
  std::vector<CornerResidual>& residuals = record.camera->residuals;
  for (CornerResidual& r : residuals) r.used = true;
  EXPECT_THAT(renderCalibrationPage(record), Not(HasSubstr("Rejected corners")));
  CornerResidual& bad = residuals[residuals.size() / 2];
  bad.used = false;
  bad.error = {3, -4};
  const std::string page = renderCalibrationPage(record);
  EXPECT_THAT(page, HasSubstr("Rejected corners"));
  EXPECT_THAT(page, HasSubstr(">+3.00<"));
  EXPECT_THAT(page, HasSubstr(">-4.00<"));
  EXPECT_THAT(page, HasSubstr(">5.00<"));
}

TEST(CalibrationPage, SaysWhereErrorsAreDrawnAsADensity) {
  CalibrationRecord record = syntheticRecord();
  const auto caption = [&] {
    return html_internal::reprojectionFigures(html_internal::cameraView(record))
        .at(1)
        .figures.front()
        .caption;
  };
  EXPECT_THAT(caption(), HasSubstr("one point per used corner"));
  CornerResidual corner = record.camera->residuals.front();
  corner.camera = 0;
  corner.used = true;
  record.camera->residuals.insert(record.camera->residuals.end(), 50'000, corner);
  EXPECT_THAT(caption(), HasSubstr("the density of all used corners"));
}

TEST(CalibrationPage, NeedsNothingFromOutside) {
  const std::string page = renderCalibrationPage(syntheticRecord());
  for (const char* loader : {"src=\"", "href=\"http", "@import", "url(http", "<link"}) {
    EXPECT_THAT(page.substr(0, page.find("<script>")), Not(HasSubstr(loader))) << loader;
  }
  EXPECT_LT(page.size(), 6'000'000U);
}

TEST(CalibrationPage, EscapesNamesFromOutside) {
  const std::string page = renderCalibrationPage(syntheticRecord({.frames = 4}));
  EXPECT_THAT(page, HasSubstr("synthetic &lt;stereo&gt; &amp; IMU"));
  EXPECT_THAT(page, Not(HasSubstr("synthetic <stereo>")));
}

TEST(CalibrationPage, GivesEveryPlotAnIdOfItsOwn) {
  std::string page = renderCalibrationPage(syntheticRecord({.frames = 20}));
  page.resize(page.find("<script>"));  // what follows are programs
  std::set<std::string> seen;
  std::size_t plots = 0;
  for (std::size_t at = page.find("<svg "); at != std::string::npos; at = page.find("<svg ", at)) {
    const std::string svg = page.substr(at, page.find("</svg>", at) + 6 - at);
    EXPECT_EQ(test::faultOfXml(svg), "");
    EXPECT_THAT(svg, Not(HasSubstr("nan")));
    for (const std::string& id : test::attributes(svg, "id")) {
      EXPECT_TRUE(seen.insert(id).second) << id;
    }
    at += svg.size();
    ++plots;
  }
  // Scene; a single view; correlations, frames and four figures of two cameras for two stages;
  // coverage; projection uncertainty; six of inertial residuals, two of biases, two of readings;
  // one of intervals, and one for each sensor.
  EXPECT_EQ(plots, 1U + 1U + 2U * (1U + 1U + 2U * 4U) + 2U + 2U + 6U + 2U + 2U + 1U + 3U);
}

TEST(CalibrationPage, IsTheSameWhenMadeFromTheStore) {
  const auto file = std::filesystem::path(::testing::TempDir()) / "plumbline_page_test.sqlite";
  std::filesystem::remove(file);
  const CalibrationRecord record = syntheticRecord({.frames = 30});
  Store(file).save(record);
  EXPECT_EQ(renderCalibrationPage(Store(file).load<CalibrationRecord>()),
            renderCalibrationPage(record));
  std::filesystem::remove(file);
}

TEST(OffsetRows, TurnTheSignWhereAToolDoes) {
  const auto rows = html_internal::offsetRows(0.0123, 1e-5);
  const auto value = [&](const std::string& tool) {
    for (const auto& row : rows) {
      if (row.tool == tool) return row.number + " = " + row.value;
    }
    return std::string("missing");
  };
  EXPECT_EQ(value("Kalibr"), "0.0123 = 12.300 ms");
  EXPECT_EQ(value("OpenVINS"), "0.0123 = 12.300 ms");
  EXPECT_EQ(value("VINS-Fusion"), "0.0123 = 12.300 ms");
  EXPECT_EQ(value("Basalt"), "12300000 = 12.300 ms");
  EXPECT_EQ(value("OKVIS2"), "-0.0123 = -12.300 ms");
  EXPECT_EQ(value("ORB-SLAM3"), "0.0123 = 12.300 ms");
}

TEST(OffsetRows, HaveEveryDigitOfTheExports) {
  EXPECT_EQ(html_internal::offsetRows(1234.5678912, 1e-5)[1].number, "1234.5678912");
  EXPECT_EQ(html_internal::offsetRows(1234.5678912, 1e-5)[5].number, "-1234.5678912");
}

TEST(OffsetRows, SmallOffsetsAreScaledAndZeroHasNoSign) {
  EXPECT_EQ(html_internal::offsetRows(1.3e-6, 4e-7)[0].value, "1.30 \u00b5s");
  EXPECT_EQ(html_internal::offsetRows(1.3e-6, std::nullopt)[1].value, "1.3 \u00b5s");
  for (const auto& row : html_internal::offsetRows(0, std::nullopt)) {
    EXPECT_EQ(row.number, "0") << row.tool;
    EXPECT_EQ(row.value, "0 s") << row.tool;
  }
}

TEST(ParameterList, NamesEachByOwnerAndUnit) {
  ParameterCovariance covariance;
  EXPECT_EQ(html_internal::parameterList(covariance), "");
  covariance.names = {"cam0.fu",   "cam0.k1",   "cam1.fu",    "T_C0C1.tx",
                      "T_C0C1.ty", "T_C0C1.rx", "time_offset"};
  covariance.units = {"px", "-", "px", "m", "m", "rad", "s"};
  EXPECT_EQ(html_internal::parameterList(covariance),
            "cam0: fu [px], k1 [-]; cam1: fu [px]; T_C0C1: tx, ty [m], rx [rad]; time_offset [s]");
}

TEST(KeyFigures, EntropyStandsWithItsParametersAndNoise) {
  CalibrationRecord record = syntheticRecord({.frames = 4});
  record.assumptions.pixel_sigma_px = 0.25;
  record.assumptions.imu_noise = ImuNoise{0.125, 1, 1, 1, 200};
  int entropies = 0;
  for (const html_internal::Card& card : html_internal::keyFigures(record)) {
    if (card.label.rfind("Entropy", 0) != 0) continue;
    ++entropies;
    const bool cameras = card.label == "Entropy, cameras";
    EXPECT_THAT(card.note, HasSubstr("assumes 0.25 px"));
    EXPECT_THAT(card.note, HasSubstr(cameras ? "T_C0C1: tx, ty, tz [m], rx, ry, rz [rad]"
                                             : "T_SC0: tx, ty, tz [m], rx, ry, rz [rad]"));
    EXPECT_EQ(card.note.find("0.125 rad/s") == std::string::npos, cameras);
  }
  EXPECT_EQ(entropies, 2);
}

TEST(KeyFigures, AFactorThatNothingTellsIsNotShown) {
  CalibrationRecord record = syntheticRecord({.frames = 4});
  record.camera_imu->imu_summary.noise.gyro = {0.5, 1, 9};
  record.camera_imu->imu_summary.noise.accel = {0.5, 1.2, 11};
  for (const html_internal::Card& card : html_internal::keyFigures(record)) {
    if (card.label == "Gyroscope residual, RMS") {
      EXPECT_THAT(card.note, HasSubstr("not known"));
    }
    if (card.label == "Accelerometer residual, RMS") {
      EXPECT_THAT(card.note, HasSubstr("1.20 \u00d7"));
    }
  }
}

TEST(DensityRemark, ShowsWhatTheVerdictJudged) {
  Finding finding;
  finding.advice = "Raise it.";
  const auto words = [&](const Finding* judged) {
    return html_internal::densityRemark("Gyro", {0.5, 3.1, 2300}, judged);
  };
  EXPECT_EQ(words(nullptr), "Gyro: 3.10 \u00d7 the assumed density (redundancy 2300): not judged.");
  EXPECT_THAT(words(&finding), HasSubstr("within the verdict's bounds"));
  finding.level = VerdictLevel::kCaution;
  EXPECT_THAT(words(&finding), HasSubstr("Raise it."));
  EXPECT_EQ(html_internal::densityRemark("Gyro", {0.5, 1, 7}, nullptr),
            "Gyro: density not known, too few residuals (redundancy 7).");
}

TEST(WithPrecisionOf, ShowsTwoDigitsOfTheDeviation) {
  EXPECT_EQ(html_internal::withPrecisionOf(458.65432, 0.08), "458.654");
  EXPECT_EQ(html_internal::withPrecisionOf(-3.2e-6, 4.1e-6), "-0.0000032");
  EXPECT_EQ(html_internal::withPrecisionOf(1234.5, 17), "1234");
}

TEST(ParameterEstimates, FindTheValueBehindAName) {
  const CalibrationRecord record = syntheticRecord({.frames = 4});
  const auto camera = parameterEstimates(record, Stage::kCamera);
  ASSERT_EQ(camera.size(), 22U);
  EXPECT_EQ(camera[0].name, "cam0.fu");
  EXPECT_EQ(camera[0].value, 458.654);
  EXPECT_NEAR(camera[0].std, 0.08, 1e-12);
  EXPECT_NEAR(*camera[0].resample_std, 0.24, 1e-12);
  EXPECT_EQ(camera[16].name, "T_C0C1.tx");
  EXPECT_EQ(camera[16].value, 0.11);
  const auto imu = parameterEstimates(record, Stage::kCameraImu);
  ASSERT_EQ(imu.size(), 7U);
  EXPECT_EQ(imu[6].value, record.camera_imu->imu.timeOffset());
  EXPECT_FALSE(imu[0].resample_std.has_value());
}

TEST(ParameterEstimates, IntervalsAreWiderWhereFewBlocksTellTheDeviation) {
  CalibrationRecord record = syntheticRecord({.frames = 4});
  const auto halfWidth = [&] {
    return parameterEstimates(record, Stage::kCamera)[0].halfWidth90().value_or(-1);
  };
  EXPECT_NEAR(halfWidth(), 1.6449 * 0.08, 1e-5);  // formal: taken for known
  StageSummary& summary = record.camera->summary;
  summary.robust_std = Eigen::VectorXd::Constant(22, 0.1);
  EXPECT_EQ(halfWidth(), -1);
  summary.robust_dof = Eigen::VectorXd::Constant(22, 5);
  EXPECT_NEAR(halfWidth(), 2.0150 * 0.1, 1e-5);
  const auto table = [&] { return html_internal::parameterBlocks(record)[0].table.value(); };
  EXPECT_EQ(table().columns.at(3).text, "90 % interval, \u00b1");
  EXPECT_EQ(table().rows[0].at(3).text, "0.20");
  record.held.emplace();
  EXPECT_NE(table().columns.at(3).text, "90 % interval, \u00b1");
}

}  // namespace
}  // namespace plumbline
