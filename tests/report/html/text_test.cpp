// SPDX-License-Identifier: BSD-3-Clause
// How pages write numbers and words: digits, units, separators, and what must not end a script.
#include "report/html/text.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "report/html/replay/sections.h"
#include "report/html/section.h"
#include "report/html/study/sections.h"
#include "report/html/trajectory/sections.h"

namespace plumbline::html_internal {
namespace {

const double kNoNumber = std::numeric_limits<double>::quiet_NaN();

TEST(TwoDigits, OfAnySize) {
  EXPECT_EQ(twoDigits(0.0804), "0.080");
  EXPECT_EQ(twoDigits(12.34), "12");
  EXPECT_EQ(twoDigits(1234), "1234");
  EXPECT_EQ(twoDigits(1.2e-4), "0.00012");
  EXPECT_EQ(twoDigits(9.9e-5), "9.9e-05");
  EXPECT_EQ(twoDigits(12345), "1.2e+04");
  for (const double none : {0.0, -1.0, kNoNumber}) EXPECT_EQ(twoDigits(none), kDash);
}

TEST(WithPrecisionOf, SixDigitsWhereNoDeviationIsKnown) {
  for (const double none : {0.0, -1.0, kNoNumber, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(withPrecisionOf(458.65432, none), "458.654") << none;
  }
  EXPECT_EQ(withPrecisionOf(1.25, 0.1), "1.25");
  EXPECT_EQ(withPrecisionOf(1.25, 9.9), "1.2");
}

TEST(ScaledSeconds, HaveTheUnitOfTheLargerOfValueAndDeviation) {
  EXPECT_EQ(scaledSeconds(1.5, 0.1), "1.50 s");
  EXPECT_EQ(scaledSeconds(-0.0136, 1e-4), "-13.60 ms");
  EXPECT_EQ(scaledSeconds(1e-3, 0), "1 ms");
  EXPECT_EQ(scaledSeconds(9.99e-4, 0), "999 \u00b5s");
  EXPECT_EQ(scaledSeconds(2.5e-8, 0), "25 ns");
  EXPECT_EQ(scaledSeconds(1e-9, 2e-3), "0.0 ms") << "next to 0 the deviation gives the unit";
  EXPECT_EQ(scaledSeconds(0.25, kNoNumber), "250 ms");
}

TEST(Grouped, ByThreesFromTheEnd) {
  EXPECT_EQ(grouped(0), "0");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(grouped(1000), "1\u2009000");
  EXPECT_EQ(grouped(123456), "123\u2009456");
  EXPECT_EQ(grouped(1234567), "1\u2009234\u2009567");
}

TEST(Readable, IsTheUnitOfPeople) {
  EXPECT_EQ(readable("m").unit, "mm");
  EXPECT_EQ(readable("m").factor, 1e3);
  EXPECT_NEAR(readable("rad").factor * std::numbers::pi, 180, 1e-12);
  EXPECT_EQ(readable("s").unit, "ms");
  EXPECT_EQ(readable("px").unit, "px");
  EXPECT_EQ(readable("px").factor, 1);
}

TEST(OrDash, HasItsFactorAndFormat) {
  EXPECT_EQ(orDash(0.125, 100, "{:.1f} %").text, "12.5 %");
  EXPECT_EQ(orDash(0.125, 100, "{:.1f} %").kind, Cell::Kind::kNumber);
  EXPECT_EQ(orDash(std::nullopt, 100, "{:.1f} %").text, kDash);
}

TEST(ScriptJson, HoldsNothingThatLooksLikeATag) {
  const std::string json = scriptJson(R"({"name":"</script><!-- > &"})");
  EXPECT_EQ(json, "{\"name\":\"\\u003c/script>\\u003c!-- > &\"}");
}

TEST(ShortCell, IsRoundedAndCutWhereSixteenBitsEnd) {
  EXPECT_EQ(shortCell(2.5), 3);
  EXPECT_EQ(shortCell(-2.6), -3);
  EXPECT_EQ(shortCell(1e6), 32767);
  EXPECT_EQ(shortCell(-1e6), -32767);
  // Corners u, v after each other, in quarters of a pixel.
  EXPECT_EQ(quarterPixels({{0, {1.25, 2.9}}, {5, {9000, -1}}}),
            (std::vector<std::int16_t>{5, 12, 32767, -4}));
}

TEST(Distinct, NamesAreThoseOfTheirFirstRows) {
  const std::vector<std::string> rows = {"b", "a", "b", "c", "a"};
  const auto names = distinct(rows, [](const std::string& row) { return row; });
  EXPECT_EQ(names, (std::vector<std::string>{"b", "a", "c"}));
  EXPECT_EQ(placeOf(names, "c"), 2U);
  EXPECT_EQ(placeOf(names, "d"), 3U);
}

TEST(PageNearest, IsThatOfTheSessionNearestToTheValue) {
  std::vector<StudySession> sessions(4);
  for (std::size_t i = 0; i < 4; ++i) sessions[i].page = std::to_string(i) + ".html";
  sessions[1].capture_s = 50;
  sessions[2].capture_s = 80;
  sessions[3].capture_s = 62;
  const auto nearest = [&](double value) {
    return pageNearest(sessions, value, [](const StudySession& s) { return s.capture_s; });
  };
  EXPECT_EQ(nearest(60), "3.html");
  EXPECT_EQ(nearest(0), "1.html");
  EXPECT_EQ(nearest(56), "1.html") << "of two as near the first";
  EXPECT_EQ(nearest(1e9), "2.html");
  sessions.resize(1);
  EXPECT_EQ(nearest(60), "");
}

TEST(WithoutEmptyColumns, OnlyThoseOfDashesGo) {
  Table table{{words("A"), number("B"), words("C")}};
  table.rows = {{words(kDash), number(kDash), words("x")}, {words("a"), number(kDash), words("")}};
  const Table left = withoutEmptyColumns(table);
  ASSERT_EQ(left.columns.size(), 2U);
  EXPECT_EQ(left.columns[0].text, "A");
  EXPECT_EQ(left.columns[1].text, "C");
  ASSERT_EQ(left.rows.size(), 2U);
  EXPECT_EQ(left.rows[0][0].text, kDash);
  EXPECT_EQ(left.rows[0][1].text, "x");
  EXPECT_EQ(left.rows[1][0].text, "a");
}

/// A study of one shift under which the sessions found these offsets.
StudyRecord shifted(const std::vector<std::optional<double>>& recovered_ms) {
  StudyRecord record;
  for (std::size_t i = 0; i < recovered_ms.size(); ++i) {
    StudySession& s = record.sessions.emplace_back();
    s.name = "s" + std::to_string(i);
    s.method = "free";
    StudyPerturbation& p = record.perturbations.emplace_back();
    p.session = s.name;
    p.offset_ms = 10;
    p.recovered_ms = recovered_ms[i];
  }
  return record;
}

TEST(PerturbationSection, TheLargestErrorIsFromTheInjectedOffset) {
  const Section section =
      perturbationSection(shifted({10.02, 9.95, 10.03, std::nullopt, kNoNumber}));
  const std::vector<Cell>& row = section.blocks.at(0).table->rows.at(0);
  std::vector<std::string> texts;
  for (const Cell& cell : row) texts.push_back(cell.text);
  // Sessions, failed; mean, deviation and the one that is 0.05 ms off.
  EXPECT_EQ(texts, (std::vector<std::string>{"10", "free", "5", "2", "10.0000", "0.044", "0.05"}));
  const Section one = perturbationSection(shifted({10.5}));
  EXPECT_EQ(one.blocks.at(0).table->rows.at(0)[5].text, kDash) << "one has no spread";
}

}  // namespace
}  // namespace plumbline::html_internal
