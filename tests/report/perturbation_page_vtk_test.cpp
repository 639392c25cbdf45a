// SPDX-License-Identifier: BSD-3-Clause
// What the page of a perturbation study shows: data on their pixels, missing values with their
// reason.
#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/report/rendered_pages.h"

namespace plumbline {
namespace {

using test::AxisMapping;
using test::drawnAt;
using test::perturbationPage;
using test::plot;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

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
  EXPECT_THAT(test::attributes(svg, "data-log"), ElementsAre("y"));
  const auto highest = test::attributes(svg, "data-highest");
  ASSERT_EQ(highest.size(), 1U) << "those that failed have no value";
  for (const PerturbationCase& c : record.cases) {
    if (c.kind != "imu-shift" || !c.problem.empty()) continue;
    EXPECT_LT(std::log10(std::abs(c.offset_error_s)), std::stod(highest.front()));
  }
}

TEST(PerturbationPage, GivesEverySeriesOfTheBasinItsOwnColour) {
  const std::string svg = plot(perturbationPage(), "perturbation-basin");
  std::set<std::string> colours;
  std::size_t entries = 0;
  for (const std::string& swatch : test::between(svg, "<polygon ", "/>")) {
    ++entries;
    EXPECT_TRUE(colours.insert(test::attributes(swatch, "fill").at(0)).second) << swatch;
  }
  EXPECT_EQ(entries, 5U);
}

// Of one point there is neither a basin nor a largest error.
TEST(PerturbationPage, ClaimsNoBasinOfASingleOffset) {
  PerturbationRecord record = test::syntheticPerturbation();
  const auto shift = std::find_if(record.cases.begin(), record.cases.end(), [](const auto& c) {
    return c.kind == "imu-shift" && c.problem.empty() && c.amount > 0;
  });
  ASSERT_NE(shift, record.cases.end());
  const PerturbationCase one = *shift;
  record.cases = {one};
  const std::string page = renderPerturbationPage(record);
  for (const char* claim :
       {"onvergence basin", "basin ends", "bound of the basin", "Largest off"}) {
    EXPECT_THAT(perturbationPage(), HasSubstr(claim));
    EXPECT_THAT(page, Not(HasSubstr(claim)));
  }
  EXPECT_THAT(page, HasSubstr("<h2>Injected time offset</h2>"));
  EXPECT_THAT(page, HasSubstr("no other offset was tested, so this shows no range of offsets"));
  const std::string svg = plot(page, "perturbation-basin");
  const AxisMapping axes(svg);
  EXPECT_TRUE(
      drawnAt(svg, axes.pixelX(one.amount), axes.pixelY(std::log10(std::abs(one.offset_error_s)))));
}

TEST(PerturbationPage, KeepsFailedCasesWithTheirProblem) {
  EXPECT_THAT(perturbationPage(), HasSubstr("failed: too few IMU samples &lt;here&gt;"));
  EXPECT_THAT(perturbationPage(), HasSubstr("26 solved, 1 failed"));
}

TEST(PerturbationPage, EscapesAnUnknownKind) {
  PerturbationRecord record = test::syntheticPerturbation();
  for (PerturbationCase& c : record.cases) c.kind = "\"><script>alert(1)</script>";
  EXPECT_THAT(renderPerturbationPage(record), Not(HasSubstr("<script>alert(1)")));
}

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

}  // namespace
}  // namespace plumbline
