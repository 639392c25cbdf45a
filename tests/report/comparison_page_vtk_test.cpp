// SPDX-License-Identifier: BSD-3-Clause
// What the page of a comparison shows: data on their pixels, missing values with their reason.
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/report/rendered_pages.h"

namespace plumbline {
namespace {

using test::comparisonPage;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(ComparisonPage, ReadsPairedPredictionsAsTheVerdict) {
  ComparisonRecord record = test::syntheticComparison();
  const auto readingAt = [&](double sigmas) {
    record.paired = {{"kalibr", "cam0", 180, sigmas * 0.004, 0.004, 0.1, 18, 2.11 * 0.004}};
    const std::string page = renderComparisonPage(record);
    return page.substr(page.find("Which predicts better, view by view"), 1500);
  };
  EXPECT_THAT(readingAt(2.5), HasSubstr("plumbline has the lower error, by 2.5"));
  EXPECT_THAT(readingAt(2), HasSubstr("no difference (2.0"));
}

TEST(ComparisonPage, SaysNoDifferenceOfEqualValuesButZero) {
  ComparisonRecord record = test::syntheticComparison();
  ComparedParameter p = record.parameters.front();
  p.unit = "rad";
  p.difference = {std::nullopt, 2.4e-16, 0.0};
  record.parameters = {p};
  std::string page = renderComparisonPage(record);
  page = page.substr(page.find("<section id=\"parameters\""));
  page.resize(page.find("</section>"));
  EXPECT_THAT(page, Not(HasSubstr("e-1")));
  EXPECT_THAT(page, Not(HasSubstr("+0<")));
  EXPECT_THAT(page, HasSubstr(">0</td>"));
}

TEST(ComparisonPage, SaysWhyAValueIsMissing) {
  const std::string& page = comparisonPage();
  EXPECT_THAT(page, HasSubstr("\u2013 (no std)"));
  EXPECT_THAT(page, HasSubstr("\u2013 (no IMU)"));
  EXPECT_THAT(page, HasSubstr("\u2013 (not in this file)"));
  EXPECT_THAT(page, HasSubstr("its camera 1 is not in the session"));
}

TEST(ComparisonPage, NamesWhoseDeviationsAreRobustAndWhoseFormal) {
  EXPECT_THAT(
      comparisonPage(),
      HasSubstr("Cluster-robust deviations, from blocks of the recording: plumbline. Formal "
                "deviations, valid only if model and assumed noise are right: kalibr."));
}

// As of given cameras, whose deviations a file states without degrees of freedom, beside T_SC0 of
// the recording.
TEST(ComparisonPage, SaysWhereACalibrationsDeviationsAreRobustInPart) {
  ComparisonRecord record = test::syntheticComparison();
  record.parameters.front().dof.clear();
  EXPECT_THAT(renderComparisonPage(record),
              HasSubstr("from blocks of the recording: plumbline (in part). Formal deviations, "
                        "valid only if model and assumed noise are right: plumbline (the others), "
                        "kalibr."));
  for (ComparedParameter& p : record.parameters) p.dof.clear();
  const std::string formal = renderComparisonPage(record);
  EXPECT_THAT(formal, HasSubstr("are right: plumbline, kalibr."));
  EXPECT_THAT(formal, Not(HasSubstr("Cluster-robust")));
}

TEST(ComparisonPage, NamesCalibrationsThatTheBarsLeaveOut) {
  EXPECT_THAT(comparisonPage(), Not(HasSubstr("Without a held-out score")));
  ComparisonRecord record = test::syntheticComparison();
  for (CalibrationScore& s : record.scores) {
    if (s.label == "kalibr") s.held_out = false;
  }
  EXPECT_THAT(renderComparisonPage(record), HasSubstr("Without a held-out score: kalibr."));
}

TEST(ComparisonPage, NamesSignificanceInWordsAndColour) {
  const std::string& page = comparisonPage();
  EXPECT_THAT(page, HasSubstr("<span class=\"dot bad\"></span>10.0 \u03c3, differs"));
  EXPECT_THAT(page, HasSubstr("<span class=\"dot caution\"></span>2.5 \u03c3, notable"));
  EXPECT_THAT(page, HasSubstr("plumbline has the lower error, by 7.8 \u03c3"));
  EXPECT_THAT(page, HasSubstr("no difference (0.2 \u03c3)"));
}

TEST(ComparisonPage, TurnsTheOffsetsSignWhereAToolDoes) {
  const std::string& page = comparisonPage();
  EXPECT_THAT(page, HasSubstr("0.0123 (12.3 ms)"));
  EXPECT_THAT(page, HasSubstr("-0.0123 (-12.3 ms)"));
  EXPECT_THAT(page, HasSubstr("12300000 (12.3 ms)"));
}

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
