// SPDX-License-Identifier: BSD-3-Clause
// What the page of trajectories shows: data on their pixels, missing values with their reason.
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/report/rendered_pages.h"

namespace plumbline {
namespace {

using test::AxisMapping;
using test::drawnAt;
using test::plot;
using test::trajectoryPage;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(TrajectoryPage, CountsFailedAndPartialRuns) {
  const std::string& page = trajectoryPage();
  EXPECT_THAT(page, HasSubstr("5 of 6 complete, 1 partial, 0 failed"));
  EXPECT_THAT(page, HasSubstr("5 of 6 complete, 0 partial, 1 failed"));
  EXPECT_THAT(page, HasSubstr("no overlap in time with &lt;truth&gt;"));
}

TEST(TrajectoryPage, PointsToTheCompletionOfSeveralRunsOnly) {
  TrajectoryRecord record = test::syntheticTrajectories();
  EXPECT_THAT(trajectoryPage(), HasSubstr("see the completion above"));
  record.runs.resize(1);
  EXPECT_THAT(renderTrajectoryPage(record), Not(HasSubstr("completion above")));
}

TEST(TrajectoryPage, PutsTruthAndEstimateOnTheirPixelsWithEqualAxes) {
  const TrajectoryRun run = test::syntheticTrajectories().runs[0];
  const std::string svg = plot(trajectoryPage(), "overlay-0-top");
  // What turns the lightness of the errors' colours on a dark ground.
  EXPECT_THAT(trajectoryPage(),
              HasSubstr("svg[id^=\"overlay-\"] polyline.data[stroke-width=\"2\"]"));
  EXPECT_GT(test::countOf(svg, "stroke-width=\"2\""), 1U);
  const AxisMapping axes(svg);
  for (const std::size_t i : {std::size_t{0}, run.t.size() - 1}) {
    for (const Eigen::Vector3d& p : {run.truth_m[i], run.estimate_m[i]}) {
      EXPECT_TRUE(drawnAt(svg, axes.pixelX(p.x()), axes.pixelY(p.y()))) << i;
    }
  }
  const double across = (axes.pixelX(1) - axes.pixelX(0)), up = axes.pixelY(0) - axes.pixelY(1);
  EXPECT_NEAR(across, up, 0.01 * across);
}

TEST(TrajectoryPage, SetsOffTheBestOfEachSequence) {
  const std::string page = trajectoryPage();
  EXPECT_THAT(page, HasSubstr("Sequences and calibrations"));
  std::size_t best = 0;
  const std::string mark = "class=\"number best\"";
  for (auto at = page.find(mark); at != std::string::npos; at = page.find(mark, at + 1)) ++best;
  EXPECT_EQ(best, 2u);
}

TEST(TrajectoryPage, SurvivesRunsThatAllFailed) {
  TrajectoryRecord record = test::syntheticTrajectories();
  record.runs = {record.runs[5]};
  const std::string page = renderTrajectoryPage(record);
  EXPECT_THAT(page, Not(HasSubstr("0.0 % of the truth")));
  EXPECT_THAT(page, Not(HasSubstr("<section id=\"overlays\"")));
  EXPECT_THAT(renderTrajectoryPage({}), HasSubstr("<section id=\"provenance\""));
}

// One run of two groups of three is not complete.
TEST(TrajectoryPage, DrawsFewRunsAsPoints) {
  const std::string svg = plot(trajectoryPage(), "ate-runs");
  std::size_t points = 0;
  std::set<std::string> boxes;
  for (const std::string& title : test::between(svg, "<title>", "</title>")) {
    if (title.find("whiskers") == std::string::npos) {
      ++points;
    } else {
      boxes.insert(title);
    }
  }
  EXPECT_EQ(points, 4U);
  EXPECT_EQ(boxes.size(), 2U);
  EXPECT_THAT(trajectoryPage(), HasSubstr("Fewer than three runs are shown as points."));
}

TEST(TrajectoryPage, SaysNoCoverageOfARunWithoutTruth) {
  TrajectoryRecord record = test::syntheticTrajectories();
  for (TrajectoryRun& run : record.runs) {
    run.without_truth = true;
    run.coverage = 0;  // as read from the store
  }
  EXPECT_THAT(trajectoryPage(), HasSubstr("Covered [%]"));
  EXPECT_THAT(renderTrajectoryPage(record), Not(HasSubstr("Covered [%]")));
}

TEST(TrajectoryPage, CountsRunsThatAreNotCompleteInMedians) {
  TrajectoryRecord record;
  for (const double ate_m : {0.2, 0.2, 0.1, 9.0}) {
    TrajectoryRun run;
    run.sequence = "s";
    run.calibration = ate_m == 0.2 ? "a" : "b";
    run.run = std::to_string(record.runs.size());
    run.ate_translation_m.rmse = ate_m;
    run.ate_translation_m.n = 10;
    record.runs.push_back(ate_m == 9 ? failedRun(run, "diverged") : run);
  }
  record.summary = {{"s", "a", 2, 2, 0, 0, 1, 0.2, VerdictLevel::kGood},
                    {"s", "b", 2, 1, 0, 1, 0.5, {}, VerdictLevel::kBad}};
  const std::string page = renderTrajectoryPage(record);
  EXPECT_THAT(page, HasSubstr("class=\"number best\">0.2000"));
  EXPECT_THAT(page, Not(HasSubstr("class=\"number best\">0.1000")));
}

TEST(TrajectoryPage, NamesParametersWhoseRunsFailedAndEffectsOfEitherSign) {
  CalibrationSensitivity s;
  s.ate_m = 0.1;
  s.noise_m = 1e-4;
  s.parameters = {{"cam0.k1", "-", 0.1, {}, {}, {}, false},
                  {"cam0.fu", "px", 1, -0.02, {}, -0.02, true},
                  {"cam0.fv", "px", 1, 0.003, {}, 0.003, true}};
  TrajectoryRecord record = test::syntheticTrajectories();
  record.sensitivity = {s};
  EXPECT_THAT(
      renderTrajectoryPage(record),
      HasSubstr("Runs with a change of cam0.k1 failed. cam0.fu has the largest effect of the "
                "others: changed by 1.0 px it lowers the ATE of 100.00 mm by 20.00 mm."));
}

TEST(TrajectoryPage, SaysASmallStepOfACoefficient) {
  CalibrationSensitivity s;
  s.ate_m = 0.1;
  s.noise_m = 1e-4;
  s.parameters = {{"cam0.k4", "-", 4e-8, -0.02, {}, -0.02, true}};
  TrajectoryRecord record = test::syntheticTrajectories();
  record.sensitivity = {s};
  EXPECT_THAT(renderTrajectoryPage(record), HasSubstr("changed by 4.0e-08 it lowers"));
}

TEST(TrajectoryPage, ShowsAHintWhoseDeviationIsNotKnown) {
  TrajectoryRecord record = test::syntheticTrajectories();
  OdometryRunRecord odometry;
  odometry.offset_hint_s = 0.0021;
  odometry.T_SC0_hint = Vector6d(Vector6d::Constant(0.0123));
  record.runs[0].odometry = odometry;
  const std::string page = renderTrajectoryPage(record);
  const std::size_t at = page.find("Extrinsics, the odometry");
  ASSERT_NE(at, std::string::npos);
  const std::string hints = page.substr(at, page.find("</table>", at) - at);
  EXPECT_THAT(hints, HasSubstr("12.3"));   // mm
  EXPECT_THAT(hints, HasSubstr("0.705"));  // degrees
  EXPECT_THAT(hints, Not(HasSubstr("\u00b1")));
}

}  // namespace
}  // namespace plumbline
