// SPDX-License-Identifier: BSD-3-Clause
// What the page of a user study shows: data on their pixels, missing values with their reason.
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/report/rendered_pages.h"

namespace plumbline {
namespace {

using test::AxisMapping;
using test::between;
using test::countOf;
using test::drawnAt;
using test::kDrawnPixel;
using test::plot;
using test::pointsOf;
using test::userStudyPage;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

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

TEST(UserStudyPage, ShowsTheWholeIntervalOfTheSpread) {
  StudyRecord record = test::syntheticUserStudy();
  for (StudySpread& s : record.statistics.spread) {
    s.ratio = 1;
    s.low = 0.03;
    s.high = 2.24;
  }
  const AxisMapping axes(plot(renderStudyPage(record), "study-spread"));
  EXPECT_GT(axes.a[3], 2.24) << "the upper end of the axis";
}

TEST(UserStudyPage, NamesTheIntervalOfTheSpreadApartFromItsMiddle) {
  const std::string svg = plot(userStudyPage(), "study-spread");
  EXPECT_THAT(svg, HasSubstr(">stated deviation<"));
  EXPECT_THAT(svg, HasSubstr(">95 % interval<"));
  // Solid is the line at 1, dashed are the ends.
  std::set<std::string> solid, dashed;
  for (const std::string& line : between(svg, "<polyline class=\"data\"", "/>")) {
    const bool is_dashed = line.find("stroke-dasharray") != std::string::npos;
    (is_dashed ? dashed : solid).insert(test::attributes(line, "stroke").at(0));
  }
  EXPECT_EQ(dashed.size(), 1U);
  EXPECT_EQ(solid.size(), 1U);
  EXPECT_NE(dashed, solid);
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
      EXPECT_NEAR(pointsOf(point).front().second, axes.pixelY(*h.rmse_px), kDrawnPixel);
    }
  }
  EXPECT_EQ(linked, record.held_out.size());
}

TEST(UserStudyPage, CountsHeldOutScoresWithoutAnError) {
  StudyRecord record = test::syntheticUserStudy();
  const std::size_t all = record.held_out.size();
  ASSERT_GT(all, 1U);
  EXPECT_THAT(userStudyPage(), Not(HasSubstr("have no RMSE")));
  record.held_out.front().rmse_px.reset();
  record.held_out.back().rmse_px = std::nan("");
  const std::string page = renderStudyPage(record);
  EXPECT_THAT(page, HasSubstr("2 of " + std::to_string(all) + " have no RMSE"));
  EXPECT_EQ(between(plot(page, "study-held-out"), "<a ", "</a>").size(), all - 2);
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

TEST(UserStudyPage, LinksNoNightToTonightsPagesWhereTonightHasNoValue) {
  StudyRecord record = test::syntheticUserStudy();
  record.nights.push_back(record.nights.back());
  ++record.nights.back().night;
  record.nights.back().held_out_rmse_px.reset();
  const auto nights = between(plot(renderStudyPage(record), "study-nights"), "<a ", ">");
  ASSERT_EQ(nights.size(), record.nights.size() - 1);
  for (const std::string& night : nights) EXPECT_THAT(night, HasSubstr("#sessions"));
}

TEST(UserStudyPage, StacksTheStagesOfASession) {
  const StudyRecord record = test::syntheticUserStudy();
  const std::string svg = plot(userStudyPage(), "study-stages");
  EXPECT_THAT(svg, AllOf(HasSubstr(">camera-IMU<"), Not(HasSubstr("camera_imu"))));
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

TEST(UserStudyPage, ShowsCountsOfTheVerdictWithoutAUnit) {
  EXPECT_THAT(userStudyPage(), HasSubstr("data-name=\"value\">1</td>"));
  EXPECT_THAT(userStudyPage(), HasSubstr("data-name=\"threshold\">\u2264\u00a00</td>"));
}

// The evidence may tell other figures in other units.
TEST(VerdictOfAPage, ShowsFindingsInTheUnitOfTheirRule) {
  StudyRecord record = test::syntheticUserStudy();
  const auto finding = [](double value, double threshold, const char* unit) {
    return Finding{"A rule", VerdictLevel::kGood, "3 us of 4 mm are 5 %", "", value, threshold,
                   unit};
  };
  record.verdict = makeVerdict(
      {finding(0.123, 0.5, "m"), finding(110, 5, "m"), finding(3.5, 2, "s"),
       finding(2e-6, 1e-6, "s"), finding(0.003, 1e-6, "s"), finding(0, 0, "s"),
       finding(0.25, 0.1, "share"), finding(0.25, 1, "share"), finding(0.004, 0, "share"),
       finding(2, 0, "1"), finding(0.15, 0.2, "x"), finding(30, 20, "-")});
  std::string shown;
  for (const std::string& cell : between(renderStudyPage(record), "data-name=\"value\">", "<")) {
    shown += cell.substr(cell.find('>') + 1);
  }
  EXPECT_EQ(shown, "123 mm<110 m<3.5 s<2 \u00b5s<3 ms<0 s<25 %<25 %<0.4 %<2<0.15<30<");
}

TEST(UserStudyPage, ShowsCountsAsCountsAndDriftsAsShares) {
  StudyRecord record = test::syntheticUserStudy();
  record.verdict = makeVerdict({{"Regressions", VerdictLevel::kBad,
                                 "ate_m of the study has become worse by 1.5 %", "", 1, 0, "1"}});
  record.alarms = {{"ate_m", "", 2, "cusum", 0, 0.015, ""},
                   {"camera_entropy_nats", "", 2, "cusum", 0, 0.3, ""}};
  const std::string page = renderStudyPage(record);
  EXPECT_THAT(page, HasSubstr("data-name=\"value\">1</td>"));
  EXPECT_THAT(page, HasSubstr("data-name=\"threshold\">\u2264\u00a00</td>"));
  const std::string alarms = page.substr(page.find("<section id=\"nights\""));
  const auto rows = between(alarms.substr(alarms.find("<tbody>")), "<tr>", "</tr>");
  EXPECT_THAT(rows.at(0), HasSubstr("+1.5 %</td>"));
  EXPECT_EQ(countOf(rows.at(0), "\u2013</td>"), 1U) << "before";
  EXPECT_EQ(countOf(rows.at(1), "\u2013</td>"), 2U) << "an entropy has no share";
}

TEST(UserStudyPage, AnEndOfAnIntervalIsZeroOnlyWhereItIs) {
  StudyRecord record = test::syntheticUserStudy();
  StudyEffect& effect = record.statistics.effects.at(0);
  const auto shown = [&](double low, double high) {
    effect.effect = {0.997, low, high};
    const std::string page = renderStudyPage(record);
    return between(page.substr(page.find(">Effects<")), "<td", "</td>").at(3);
  };
  EXPECT_THAT(shown(0.994, 0.99959), HasSubstr(">-0.6 % to -0.041 %<"));
  EXPECT_THAT(shown(0.994, 1), HasSubstr(">-0.6 % to +0.0 %<"));
  EXPECT_THAT(shown(0.9, 0.9904), HasSubstr(">-10.0 % to -1.0 %<"));
}

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

TEST(UserStudyPage, TellsNoDigitsOfTheArithmetic) {
  StudyRecord record = test::syntheticUserStudy();
  record.perturbations.resize(1);
  record.perturbations[0].offset_ms = 10;
  record.perturbations[0].recovered_ms = 10 + 3e-13;
  std::string page = renderStudyPage(record);
  EXPECT_THAT(page.substr(page.find("<section id=\"perturbations\"")),
              HasSubstr(">&lt; 1e-6</td>"));
  record.perturbations[0].recovered_ms = 10.002;
  page = renderStudyPage(record);
  EXPECT_THAT(page.substr(page.find("<section id=\"perturbations\"")), HasSubstr(">0.002</td>"));
}

// The spread of the sessions says which digits of their mean tell anything; of one session its
// formal deviation does.
TEST(UserStudyPage, TellsTheMeanOffsetToTheDigitsOfItsSpread) {
  StudyRecord record = test::syntheticUserStudy();
  const auto rowOf = [&](std::optional<double> std_s) {
    record.statistics.methods.front().time_offset_mean_s = 0.0106355;
    record.statistics.methods.front().time_offset_std_s = std_s;
    for (StudySession& s : record.sessions) s.time_offset_std_s = 0.0082;
    const std::string page = renderStudyPage(record);
    return page.substr(page.find("<section id=\"offsets\""), 1500);
  };
  EXPECT_THAT(rowOf(3.5e-4), HasSubstr(">10.64</td>"));
  EXPECT_THAT(rowOf(std::nullopt), HasSubstr(">10.6</td>"));
}

TEST(UserStudyPage, CallsOneSessionNoMedian) {
  StudyRecord record = test::syntheticUserStudy();
  const std::string method = record.statistics.methods.front().method;
  EXPECT_THAT(userStudyPage(), Not(HasSubstr("one session")));
  bool first = true;
  for (StudySession& s : record.sessions) {
    if (s.method != method || !s.held_out_rmse_px) continue;
    if (!std::exchange(first, false)) s.held_out_rmse_px.reset();
  }
  EXPECT_THAT(renderStudyPage(record), HasSubstr("<p class=\"note\">one session</p>"));
}

}  // namespace
}  // namespace plumbline
