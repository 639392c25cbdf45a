// SPDX-License-Identifier: BSD-3-Clause
// How a page shows a verdict, by findings made up by hand.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/html/page.h"

namespace plumbline::html_internal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

Verdict verdictOf(const std::vector<Finding>& findings) {
  Verdict verdict;
  verdict.findings = findings;
  for (const Finding& f : findings) verdict.level = std::max(verdict.level, f.level);
  return verdict;
}

/// The page of nothing but a verdict.
std::string pageOf(const std::vector<Finding>& findings, const std::string& good_word = "good") {
  const Provenance provenance;
  Page page{"", "", provenance, verdictOf(findings), {}, {}, {}};
  page.good_word = good_word;
  return renderPage(page);
}

TEST(VerdictOfAPage, ASubjectHasItsWorstFindingAndNoneWhereItWasNotJudged) {
  const auto good = VerdictLevel::kGood, bad = VerdictLevel::kBad;
  Finding cameras{"a", good}, more{"b", bad}, noise{"c", VerdictLevel::kCaution}, all{"d", bad};
  cameras.subject = more.subject = FindingSubject::kCameras;
  noise.subject = FindingSubject::kImuNoise;
  EXPECT_THAT(
      pageOf({more, cameras, noise, all}),
      AllOf(HasSubstr("</span>cameras: bad<"), HasSubstr("</span>extrinsics and time: not judged<"),
            HasSubstr("</span>IMU noise: caution<"), HasSubstr("</span>recording: not judged<")));
  EXPECT_THAT(pageOf({all}), Not(HasSubstr("class=\"chip\""))) << "the badge says all";
}

// A comparison without a recording has no input.
TEST(VerdictOfAPage, TheLineBelowTheTitleBeginsWithWhatThereIs) {
  Provenance provenance;
  provenance.date = "2026-01-02";
  EXPECT_THAT(renderPage({"", "", provenance, {}, {}, {}, {}}),
              HasSubstr("<p class=\"meta\">2026-01-02 &middot;"));
  provenance.input = "a recording";
  EXPECT_THAT(renderPage({"", "", provenance, {}, {}, {}, {}}),
              HasSubstr("<p class=\"meta\">a recording &middot; 2026-01-02"));
}

// Findings are written for terminals. What only looks like a unit stays.
TEST(VerdictOfAPage, HasTheSignsOfPrint) {
  Finding f{"delay", VerdictLevel::kCaution, "0.2 deg (+- 0.1) and 5 us in m/s^2, 4.2 sigma"};
  f.value = 3;
  f.unit = "sigma";
  f.advice = "turn by degrees; let us know; run with a 2 sigmatisme";
  EXPECT_THAT(
      pageOf({f}),
      AllOf(HasSubstr(
                "0.2\u00a0\u00b0 (\u00b1 0.1) and 5\u00a0\u00b5s in m/s\u00b2, 4.2\u00a0\u03c3<"),
            HasSubstr(">3\u00a0\u03c3<"), HasSubstr("turn by degrees; let us know"),
            HasSubstr("2 sigmatisme")));
}

// On which side of its threshold a rule is met.
TEST(VerdictOfAPage, ThresholdsSayOnWhichSideIsGood) {
  const auto shown = [](VerdictLevel level, double value) {
    Finding f{"rule", level};
    f.value = value;
    f.threshold = 20;
    f.unit = "s";
    return pageOf({f});
  };
  EXPECT_THAT(shown(VerdictLevel::kGood, 30), HasSubstr(">\u2265\u00a020 s<"));
  EXPECT_THAT(shown(VerdictLevel::kGood, 20), HasSubstr(">\u2264\u00a020 s<"));
  EXPECT_THAT(shown(VerdictLevel::kCaution, 30), HasSubstr(">\u2264\u00a020 s<"));
  EXPECT_THAT(shown(VerdictLevel::kBad, 10), HasSubstr(">\u2265\u00a020 s<"));
  EXPECT_THAT(shown(VerdictLevel::kCaution, std::nan("")), HasSubstr(">20 s<"));
}

TEST(VerdictOfAPage, CountsHaveNoExponent) {
  Finding f{"views", VerdictLevel::kGood};
  f.value = 1416;
  f.threshold = 20;
  f.unit = "1";
  EXPECT_THAT(pageOf({f}), AllOf(HasSubstr(">1416<"), HasSubstr(">\u2265\u00a020<")));
  f.unit = "s";
  f.value = 12345.6;
  EXPECT_THAT(pageOf({f}), AllOf(HasSubstr(">12346 s<"), HasSubstr(">\u2265\u00a020 s<")));
}

// One cell over both rows where columns are beside each other, and a cell in each where a narrow
// window puts them below each other.
TEST(VerdictOfAPage, AdviceThatRulesShareIsInEveryRow) {
  Finding gyro{"gyroscope", VerdictLevel::kCaution}, accel{"accelerometer", VerdictLevel::kCaution};
  gyro.advice = accel.advice = "raise it";
  const std::string page = pageOf({gyro, accel});
  EXPECT_THAT(
      page,
      AllOf(HasSubstr("<td class=\"advice\" rowspan=\"2\" data-name=\"what to do\">raise it<"),
            HasSubstr("<td class=\"advice again\" data-name=\"what to do\">raise it<")));
  EXPECT_THAT(pageOf({gyro}), Not(HasSubstr("class=\"advice again\"")));
}

// The reason stands once, in one cell over all its rows; others that were not judged have their
// own.
TEST(VerdictOfAPage, SaysOnceWhyRulesWereNotJudged) {
  const auto open = [](const char* rule, const char* why) {
    Finding f{rule, VerdictLevel::kGood, std::string("not judged: ") + why};
    f.value = std::nan("");
    return f;
  };
  const std::string page = pageOf(
      {open("cameras", "3 draws"), open("size", "gentle motion"), open("extrinsics", "3 draws")});
  EXPECT_THAT(page, AllOf(HasSubstr("<td class=\"evidence\" rowspan=\"2\">3 draws</td>"),
                          HasSubstr("<td class=\"evidence again\">3 draws</td>"),
                          HasSubstr("<td class=\"evidence\" rowspan=\"1\">gentle motion</td>"),
                          Not(HasSubstr("not judged: "))));
}

TEST(VerdictOfAPage, CountsTheRulesThatAreMet) {
  const Finding good{"met", VerdictLevel::kGood}, doubt{"doubt", VerdictLevel::kCaution};
  EXPECT_THAT(pageOf({good, doubt, good}),
              AllOf(HasSubstr("<span class=\"badge\">Caution</span>"),
                    HasSubstr("2 of 3 rules are met"), HasSubstr("<td class=\"rule\">doubt</td>")));
  EXPECT_THAT(pageOf({good}), AllOf(HasSubstr("<span class=\"badge\">Good</span>"),
                                    HasSubstr("1 of 1 rule is met")));
  Finding open{"open", VerdictLevel::kGood};
  open.value = std::nan("");
  open.unit = "share";
  open.subject = FindingSubject::kCameras;
  EXPECT_THAT(pageOf({good, open}),
              AllOf(HasSubstr("1 of 2 rules are met; 1 could not be judged."),
                    HasSubstr("1 of 2 rules are met: show"), HasSubstr("</span>not judged</td>"),
                    HasSubstr("</span>cameras: not judged<"), Not(HasSubstr(">nan"))));
  open.evidence = "not judged: too few seconds";
  EXPECT_THAT(pageOf({good, open}),
              AllOf(HasSubstr(">too few seconds<"), Not(HasSubstr("not judged: too few seconds"))));
  // A word of its own praises nothing.
  EXPECT_THAT(pageOf({good}, "complete"),
              AllOf(HasSubstr("<span class=\"badge\">Complete</span>"), HasSubstr("neutral")));
}

}  // namespace
}  // namespace plumbline::html_internal
