// SPDX-License-Identifier: BSD-3-Clause
// The columns of the scores' table are cameras, whatever order a recording has them in.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/html/calibration/sections.h"
#include "tests/report/calibration_scores.h"

namespace plumbline::html_internal {
namespace {

using plumbline::test::scoreOf;
using ::testing::ElementsAre;

TEST(HeldScores, AColumnIsOneCameraInEveryRow) {
  HeldCalibration held;
  held.scores = {scoreOf("own", {{"left", 0.1}}), scoreOf("a", {{"left", 0.1}, {"right", 0.2}}),
                 scoreOf("b", {{"right", 0.4}, {"left", 0.3}}), scoreOf("c", {{"right", 0.5}})};
  // The first is this recording, whichever of them are held out.
  held.scores.front().held_out = true;
  const Section section = heldScoresSection(held);
  ASSERT_EQ(section.blocks.at(0).heading, "This recording");
  ASSERT_EQ(section.blocks.at(1).heading, "Other recordings");
  ASSERT_EQ(section.blocks[0].table->rows.size(), 1U);
  ASSERT_TRUE(section.blocks[1].table.has_value());
  const Table& table = *section.blocks[1].table;
  std::size_t left = 0;
  while (table.columns.at(left).text != "left [px]") ++left;
  ASSERT_EQ(table.columns.at(left + 1).text, "right [px]");
  std::vector<std::string> lefts, rights;
  for (const auto& row : table.rows) {
    lefts.push_back(row.at(left).text);
    rights.push_back(row.at(left + 1).text);
  }
  EXPECT_THAT(lefts, ElementsAre("0.1000", "0.3000", "\u2013"));
  EXPECT_THAT(rights, ElementsAre("0.2000", "0.4000", "0.5000"));
}

}  // namespace
}  // namespace plumbline::html_internal
