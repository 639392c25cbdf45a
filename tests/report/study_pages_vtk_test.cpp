// SPDX-License-Identifier: BSD-3-Clause
// The pages of studies: complete, self-contained, sound markup, the same again from the store. That
// they look right is for the browser test; what each shows has a file of its own.
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/store/store.h"
#include "tests/report/rendered_pages.h"

namespace plumbline {
namespace {

using test::between;
using test::comparisonPage;
using test::countOf;
using test::perturbationPage;
using test::renderComparison;
using test::renderPerturbation;
using test::renderTrajectory;
using test::renderUserStudy;
using test::trajectoryPage;
using test::userStudyPage;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

struct Study {
  const char* name;
  const std::string& (*page)();
  std::string (*render)();
  std::vector<const char*> sections;
  std::size_t plots;
};

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
  EXPECT_EQ(renderPerturbationPage(store.load<PerturbationRecord>()), perturbationPage());
  EXPECT_EQ(renderTrajectoryPage(store.load<TrajectoryRecord>()), trajectoryPage());
  EXPECT_EQ(renderComparisonPage(store.load<ComparisonRecord>()), comparisonPage());
  EXPECT_EQ(renderStudyPage(store.load<StudyRecord>()), userStudyPage());
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace plumbline
