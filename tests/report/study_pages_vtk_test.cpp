// SPDX-License-Identifier: BSD-3-Clause
// The pages of studies: complete, self-contained, sound markup, data on their pixels, missing
// values with their reason, the same again from the store. That they look right is for the browser
// test.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <set>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/html/comparison/page.h"
#include "report/html/perturbation/page.h"
#include "report/html/study/page.h"
#include "report/html/trajectory/page.h"
#include "report/store/store.h"
#include "tests/report/markup.h"
#include "tests/report/synthetic_studies.h"
#include "tests/report/synthetic_user_study.h"

namespace plumbline {
namespace {

using test::AxisMapping;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kStudyPixel = 0.11;  // coordinates are written to a tenth of a pixel

struct Study {
  const char* name;
  const std::string& (*page)();
  std::string (*render)();
  std::vector<const char*> sections;
  std::size_t plots;
};

std::string renderPerturbation() { return renderPerturbationPage(test::syntheticPerturbation()); }
std::string renderTrajectory() { return renderTrajectoryPage(test::syntheticTrajectories()); }
std::string renderUserStudy() { return renderStudyPage(test::syntheticUserStudy()); }
std::string renderComparison() { return renderComparisonPage(test::syntheticComparison()); }

// Each page is rendered once for all tests that only read it.
const std::string& perturbationPage() {
  static const std::string page = renderPerturbation();
  return page;
}
const std::string& trajectoryPage() {
  static const std::string page = renderTrajectory();
  return page;
}
const std::string& userStudyPage() {
  static const std::string page = renderUserStudy();
  return page;
}
const std::string& comparisonPage() {
  static const std::string page = renderComparison();
  return page;
}

// Trajectories: two boxes, two views of eleven runs, positions and orientations of these over time,
// errors of position and rotation of two sequences over time, two relative.
const Study kStudies[] = {
    {"perturbation",
     &perturbationPage,
     &renderPerturbation,
     {"key-figures", "basin", "changes", "cases", "base", "provenance"},
     1 + 3},
    {"trajectory",
     &trajectoryPage,
     &renderTrajectory,
     {"key-figures", "runs", "ate", "paired", "overlays", "error-time", "rpe", "clock-offset",
      "hand-eye", "nees", "association", "provenance"},
     2 + 4 * 11 + 2 * 2 + 2},
    {"comparison",
     &comparisonPage,
     &renderComparison,
     {"key-figures", "calibrations", "parameters", "transforms", "time-offset", "scores", "entropy",
      "differences", "uncertainties", "runs", "overlays", "provenance"},
     1 + 2 * 2 + 1 + 2 + 4 * 11 + 2 * 2 + 2},
    {"study",
     &userStudyPage,
     &renderUserStudy,
     {"key-figures", "results", "order", "time", "trajectories", "held-out", "entropies", "offsets",
      "perturbations", "spread", "board", "tools", "nights", "failures", "sessions", "provenance"},
     10}};

std::string withoutScripts(std::string page) {
  page.resize(page.find("<script>"));
  return page;
}

std::vector<std::string> between(const std::string& text, const std::string& open,
                                 const std::string& close) {
  std::vector<std::string> found;
  for (std::size_t at = text.find(open); at != std::string::npos; at = text.find(open, at)) {
    const std::size_t last = text.find(close, at);
    if (last == std::string::npos) break;
    found.push_back(text.substr(at, last + close.size() - at));
    at = last + close.size();
  }
  return found;
}

std::size_t countOf(const std::string& text, const std::string& what) {
  return between(text, what, what.substr(what.size() - 1)).size();
}

std::string plot(const std::string& page, const std::string& id) {
  for (const std::string& svg : between(page, "<svg ", "</svg>")) {
    if (svg.find("id=\"" + id + "\"") != std::string::npos) return svg;
  }
  return "";
}

/// Every point drawn as a line or a marker.
std::vector<std::pair<double, double>> pointsOf(const std::string& svg) {
  std::vector<std::pair<double, double>> points;
  for (const char* attribute : {"points", "d"}) {
    for (const std::string& text : test::attributes(svg, attribute)) {
      const auto list = test::numbers(text);
      for (std::size_t i = 0; i + 1 < list.size(); i += 2)
        points.emplace_back(list[i], list[i + 1]);
    }
  }
  return points;
}

bool drawnAt(const std::string& svg, double x, double y) {
  for (const auto& [px, py] : pointsOf(svg)) {
    if (std::abs(px - x) <= kStudyPixel && std::abs(py - y) <= kStudyPixel) return true;
  }
  return false;
}

class StudyPages : public ::testing::TestWithParam<Study> {};

TEST_P(StudyPages, HaveEverySectionAndAnEntryForIt) {
  const std::string& page = GetParam().page();
  for (const char* id : GetParam().sections) {
    EXPECT_THAT(page, HasSubstr("<section id=\"" + std::string(id) + "\"")) << id;
    EXPECT_THAT(page, HasSubstr("<a href=\"#" + std::string(id) + "\"")) << id;
  }
  EXPECT_THAT(page, HasSubstr("sha256:0f3a9c"));
}

TEST_P(StudyPages, GiveEveryPlotSoundMarkupAndAnIdOfItsOwn) {
  const std::string page = withoutScripts(GetParam().page());
  std::set<std::string> seen;
  const auto plots = between(page, "<svg ", "</svg>");
  for (const std::string& svg : plots) {
    EXPECT_EQ(test::faultOfXml(svg), "");
    for (const std::string& id : test::attributes(svg, "id")) {
      EXPECT_TRUE(seen.insert(id).second) << id;
    }
  }
  EXPECT_EQ(plots.size(), GetParam().plots);
}

TEST_P(StudyPages, SayNoNumberThatIsNone) {
  const std::string page = withoutScripts(GetParam().page());
  EXPECT_THAT(page, Not(ContainsRegex("[ >(,-]nan[ <),]")));
  EXPECT_THAT(page, Not(ContainsRegex("[ >(,-]inf[ <),]")));
}

TEST_P(StudyPages, GiveEveryRowACellForEachColumn) {
  const std::string& page = GetParam().page();
  std::size_t rows = 0;
  for (const std::string& table : between(page, "<table>", "</table>")) {
    const std::size_t columns = countOf(table, "<th ") + countOf(table, "<th>");
    for (const std::string& row : between(table.substr(table.find("<tbody>")), "<tr>", "</tr>")) {
      EXPECT_EQ(countOf(row, "<td ") + countOf(row, "<td>"), columns) << row;
      ++rows;
    }
  }
  EXPECT_GT(rows, 10U);
}

TEST_P(StudyPages, NeedNothingFromOutsideAndEscapeNames) {
  const std::string page = withoutScripts(GetParam().page());
  for (const char* loader : {"src=\"", "href=\"http", "@import", "url(http", "<link"}) {
    EXPECT_THAT(page, Not(HasSubstr(loader))) << loader;
  }
  for (const char* raw : {"<of>", "<here>", "<truth>", "<two>", "<both>", "<inverted>", "<a> "}) {
    EXPECT_THAT(page, Not(HasSubstr(raw))) << raw;
  }
  EXPECT_EQ(page, withoutScripts(GetParam().render()));
}

INSTANTIATE_TEST_SUITE_P(Each, StudyPages, ::testing::ValuesIn(kStudies),
                         [](const auto& study) { return study.param.name; });

TEST(StudyPagesFromTheStore, AreTheSame) {
  const auto file = std::filesystem::path(::testing::TempDir()) / "plumbline_study_pages.sqlite";
  std::filesystem::remove(file);
  const Store store(file);
  store.save(test::syntheticPerturbation());
  store.save(test::syntheticTrajectories());
  store.save(test::syntheticComparison());
  store.save(test::syntheticUserStudy());
  EXPECT_EQ(renderPerturbationPage(store.loadPerturbation()), perturbationPage());
  EXPECT_EQ(renderTrajectoryPage(store.loadTrajectory()), trajectoryPage());
  EXPECT_EQ(renderComparisonPage(store.loadComparison()), comparisonPage());
  EXPECT_EQ(renderStudyPage(store.loadStudy()), userStudyPage());
  std::filesystem::remove(file);
}

TEST(UserStudyPage, LinksEveryPointOfASession) {
  const std::string& page = userStudyPage();
  for (const char* id : {"study-ate", "study-held-out", "study-entropy-camera", "study-offsets",
                         "study-board", "study-survival", "study-spread"}) {
    const std::string svg = plot(page, id);
    const auto links = between(svg, "<a ", "</a>");
    EXPECT_FALSE(links.empty()) << id;
    for (const std::string& point : links) EXPECT_THAT(point, HasSubstr("sessions/")) << id;
  }
}

TEST(UserStudyPage, SaysWhichRatiosOfSpreadAreBeyondTheAxis) {
  StudyRecord record = test::syntheticUserStudy();
  EXPECT_THAT(userStudyPage(), Not(HasSubstr("Ratios above 10")));
  record.statistics.spread.front().ratio = 40;
  EXPECT_THAT(renderStudyPage(record), HasSubstr("Ratios above 10 stand there (1)"));
}

TEST(UserStudyPage, LeadsFromEveryPointToItsSession) {
  const StudyRecord record = test::syntheticUserStudy();
  const std::string svg = plot(userStudyPage(), "study-held-out");
  const AxisMapping axes(svg);
  ASSERT_FALSE(record.held_out.empty());
  std::size_t linked = 0;
  for (const std::string& point : between(svg, "<a ", "</a>")) {
    for (const StudyHeldOut& h : record.held_out) {
      const std::string page = "sessions/" + h.session + "/report.html";
      if (point.find(page) == std::string::npos ||
          point.find(h.session + ", " + h.recording) == std::string::npos) {
        continue;
      }
      ++linked;
      EXPECT_NEAR(pointsOf(point).front().second, axes.pixelY(*h.rmse_px), kStudyPixel);
    }
  }
  EXPECT_EQ(linked, record.held_out.size());
}

TEST(UserStudyPage, LeadsFromMediansToTheSessionNearestToThem) {
  const auto bars = between(plot(userStudyPage(), "study-stages"), "<a ", ">");
  const StudyRecord record = test::syntheticUserStudy();
  std::size_t sessions = 0;
  for (const StudySession& s : record.sessions) sessions += s.stages.empty() ? 0 : 1;
  std::size_t stages = 0;
  for (const StudySession& s : record.sessions) stages = std::max(stages, s.stages.size());
  EXPECT_EQ(bars.size(), stages * (record.methods.size() + sessions)) << "each bar has a link";
  for (const std::string& bar : bars) EXPECT_THAT(bar, HasSubstr("sessions/"));
  const auto nights = between(plot(userStudyPage(), "study-nights"), "<a ", ">");
  ASSERT_EQ(nights.size(), record.nights.size());
  for (std::size_t i = 0; i + 1 < nights.size(); ++i) {
    EXPECT_THAT(nights[i], HasSubstr("#sessions")) << "its pages are gone";
  }
  EXPECT_THAT(nights.back(), HasSubstr("sessions/"));
}

TEST(UserStudyPage, StacksTheStagesOfASession) {
  const StudyRecord record = test::syntheticUserStudy();
  const std::string svg = plot(userStudyPage(), "study-stages");
  const AxisMapping axes(svg);
  const StudySession& s = record.sessions.front();
  EXPECT_TRUE(drawnAt(svg, axes.pixelX(2 - 0.35), axes.pixelY(s.stages[0].seconds)));
  EXPECT_TRUE(
      drawnAt(svg, axes.pixelX(2 + 0.35), axes.pixelY(s.stages[0].seconds + s.stages[1].seconds)));
}

TEST(UserStudyPage, SaysTheResultsFirstAndTheFailuresWithTheirMessages) {
  const std::string& page = userStudyPage();
  const auto words = page.find("guided has 18 % lower held-out RMSE");
  ASSERT_NE(words, std::string::npos);
  EXPECT_LT(words, page.find("<svg "));
  EXPECT_THAT(page, HasSubstr("cam1 saw the target in 0 frames"));
  EXPECT_THAT(page, HasSubstr("<a href=\"sessions/p01_free/report.html\">p01_free</a>"));
}

TEST(PerturbationPage, PutsErrorsOfTheBasinOnTheirPixels) {
  const PerturbationRecord record = test::syntheticPerturbation();
  const std::string svg = plot(perturbationPage(), "perturbation-basin");
  const AxisMapping axes(svg);
  for (const PerturbationCase& c : record.cases) {
    if (c.kind != "imu-shift" || !c.problem.empty()) continue;
    EXPECT_TRUE(
        drawnAt(svg, axes.pixelX(c.amount), axes.pixelY(std::log10(std::abs(c.offset_error_s)))))
        << c.amount;
  }
  EXPECT_THAT(svg, HasSubstr(">failed<"));
  EXPECT_THAT(svg, HasSubstr("injected offset [ms]"));
}

// A count has no unit.
TEST(UserStudyPage, ShowsCountsOfTheVerdictWithoutAUnit) {
  EXPECT_THAT(userStudyPage(), HasSubstr("data-name=\"value\">1</td>"));
  EXPECT_THAT(userStudyPage(), HasSubstr("data-name=\"threshold\">0</td>"));
}

// Also where its evidence tells of a share; a cumulated drift is one of the first nights' value.
TEST(UserStudyPage, ShowsCountsAsCountsAndDriftsAsShares) {
  StudyRecord record = test::syntheticUserStudy();
  record.verdict = makeVerdict({{"Regressions", VerdictLevel::kBad,
                                 "ate_m of the study has become worse by 1.5 %", "", 1, 0, "1"}});
  record.alarms = {{"ate_m", "", 2, "cusum", 0, 0.015, ""},
                   {"camera_entropy_nats", "", 2, "cusum", 0, 0.3, ""}};
  const std::string page = renderStudyPage(record);
  EXPECT_THAT(page, HasSubstr("data-name=\"value\">1</td>"));
  EXPECT_THAT(page, HasSubstr("data-name=\"threshold\">0</td>"));
  const std::string alarms = page.substr(page.find("<section id=\"nights\""));
  const auto rows = between(alarms.substr(alarms.find("<tbody>")), "<tr>", "</tr>");
  EXPECT_THAT(rows.at(0), HasSubstr("+1.5 %</td>"));
  EXPECT_EQ(countOf(rows.at(0), "\u2013</td>"), 1U) << "before";
  EXPECT_EQ(countOf(rows.at(1), "\u2013</td>"), 2U) << "an entropy has no share";
}

// A verdict of its calibration is no reason that a participant gave.
TEST(UserStudyPage, GivesNoReasonForGivingUp) {
  StudyRecord record = test::syntheticUserStudy();
  const auto session = std::find_if(record.sessions.begin(), record.sessions.end(),
                                    [](const StudySession& s) { return !s.finished; });
  ASSERT_NE(session, record.sessions.end());
  const auto row = [&] {
    const std::string page = renderStudyPage(record);
    const std::string failures = page.substr(page.find("<section id=\"failures\""));
    for (const auto& r : between(failures.substr(failures.find("<tbody>")), "<tr>", "</tr>")) {
      if (r.find(session->name) != std::string::npos) return r;
    }
    return std::string();
  };
  session->verdict = VerdictLevel::kCaution;
  session->verdict_sentence = "Shape of the target";
  EXPECT_THAT(row(), HasSubstr("gave up<"));
  EXPECT_THAT(row(), Not(HasSubstr("Shape of the target")));
  session->verdict = VerdictLevel::kBad;
  EXPECT_THAT(row(), HasSubstr("gave up, bad verdict<"));
  EXPECT_THAT(row(), HasSubstr("Shape of the target"));
}

TEST(UserStudyPage, HasNoDeviationOfASingleSession) {
  StudyRecord record = test::syntheticUserStudy();
  record.perturbations.resize(1);
  const std::string page = renderStudyPage(record);
  const std::string section = page.substr(page.find("<section id=\"perturbations\""));
  const std::string row = between(section.substr(section.find("<tbody>")), "<tr>", "</tr>").at(0);
  EXPECT_EQ(countOf(row, "\u2013</td>"), 1U) << row;
}

TEST(PerturbationPage, KeepsFailedCasesWithTheirProblem) {
  EXPECT_THAT(perturbationPage(), HasSubstr("failed: too few IMU samples &lt;here&gt;"));
  EXPECT_THAT(perturbationPage(), HasSubstr("26 solved, 1 failed"));
}

// A store may hold any text as a kind; titles are escaped.
TEST(PerturbationPage, EscapesAnUnknownKind) {
  PerturbationRecord record = test::syntheticPerturbation();
  for (PerturbationCase& c : record.cases) c.kind = "\"><script>alert(1)</script>";
  EXPECT_THAT(renderPerturbationPage(record), Not(HasSubstr("<script>alert(1)")));
}

// The worst error, rather than the worst that is a number.
TEST(PerturbationPage, ShowsAnErrorThatIsNoNumber) {
  PerturbationRecord record = test::syntheticPerturbation();
  const auto shift = std::find_if(record.cases.begin(), record.cases.end(), [](const auto& c) {
    return c.kind == "imu-shift" && c.problem.empty();
  });
  ASSERT_NE(shift, record.cases.end());
  shift->offset_error_s = std::nan("");
  const std::string page = renderPerturbationPage(record);
  const std::string card = page.substr(page.find("Largest offset error"), 200);
  EXPECT_THAT(card, HasSubstr("nan"));
  EXPECT_THAT(card, HasSubstr(fmt::format("at {:+g} ms injected", shift->amount)));
}

// As the verdict has it: beyond the 95 % interval.
TEST(ComparisonPage, ReadsPairedPredictionsAsTheVerdict) {
  ComparisonRecord record = test::syntheticComparison();
  const auto readingAt = [&](double sigmas) {
    record.paired = {{"kalibr", "cam0", 180, sigmas * 0.004, 0.004, 0.1, 18, 2.11 * 0.004}};
    const std::string page = renderComparisonPage(record);
    return page.substr(page.find("Which predicts better, view by view"), 1500);
  };
  EXPECT_THAT(readingAt(2.5), HasSubstr("plumbline predicts better, by 2.5"));
  EXPECT_THAT(readingAt(2), HasSubstr("no difference (2.0"));
}

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
  const AxisMapping axes(svg);
  for (const std::size_t i : {std::size_t{0}, run.t.size() - 1}) {
    for (const Eigen::Vector3d& p : {run.truth_m[i], run.estimate_m[i]}) {
      EXPECT_TRUE(drawnAt(svg, axes.pixelX(p.x()), axes.pixelY(p.y()))) << i;
    }
  }
  const double across = (axes.pixelX(1) - axes.pixelX(0)), up = axes.pixelY(0) - axes.pixelY(1);
  EXPECT_NEAR(across, up, 0.01 * across);
}

// a has an error in both sequences, and one value a row is the smallest.
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

// Half of b's runs failed: the smallest of those that are left is no median, and not the best.
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

TEST(ComparisonPage, SaysWhyAValueIsMissing) {
  const std::string& page = comparisonPage();
  EXPECT_THAT(page, HasSubstr("\u2013 (no std)"));
  EXPECT_THAT(page, HasSubstr("\u2013 (no IMU)"));
  EXPECT_THAT(page, HasSubstr("\u2013 (not in this file)"));
  EXPECT_THAT(page, HasSubstr("its camera 1 is not in the session"));
}

TEST(ComparisonPage, NamesSignificanceInWordsAndColour) {
  const std::string& page = comparisonPage();
  EXPECT_THAT(page, HasSubstr("<span class=\"dot bad\"></span>10.0 \u03c3, differs"));
  EXPECT_THAT(page, HasSubstr("<span class=\"dot caution\"></span>2.5 \u03c3, notable"));
  EXPECT_THAT(page, HasSubstr("plumbline predicts better, by 7.8 \u03c3"));
  EXPECT_THAT(page, HasSubstr("no difference (0.2 \u03c3)"));
}

TEST(ComparisonPage, TurnsTheOffsetsSignWhereAToolDoes) {
  const std::string& page = comparisonPage();
  EXPECT_THAT(page, HasSubstr("0.0123 (12.3 ms)"));
  EXPECT_THAT(page, HasSubstr("-0.0123 (-12.3 ms)"));
  EXPECT_THAT(page, HasSubstr("12300000 (12.3 ms)"));
}

// What export writes: camera 0's, where the table above has the mean for comparing.
TEST(ComparisonPage, ShowsTheOffsetOfCamera0AndSaysHowFarTheOthersAre) {
  ComparisonRecord record = test::syntheticComparison();
  record.calibrations[0].calibration.imu->time_offsets = {{0.001}, {0.005, true}};
  record.offsets[0] = {"plumbline", 0.003, std::nullopt, {0.001, 0.005}};
  const std::string page = renderComparisonPage(record);
  EXPECT_THAT(page, HasSubstr("0.001 (1 ms)"));
  EXPECT_THAT(page, Not(HasSubstr("0.003 (3 ms)")));
  EXPECT_THAT(page, HasSubstr("plumbline: The cameras are not synchronised: this is the offset of "
                              "cam0. For a tool with one offset for all, add 4 ms to the image "
                              "stamps of cam1 first."));
}

TEST(ComparisonPage, StatesRangeAlignmentAndMethodOfItsMaps) {
  const std::string& page = comparisonPage();
  EXPECT_THAT(page, HasSubstr("cam0: kalibr - plumbline, at infinity"));
  EXPECT_THAT(page, HasSubstr("rotation 0.1281\u00b0, translation (1.00, 0.00, -2.00) mm"));
  EXPECT_THAT(page, HasSubstr("cross-reprojection on V2_02"));
  EXPECT_THAT(page, HasSubstr("at 2.5 m"));
}

}  // namespace
}  // namespace plumbline
