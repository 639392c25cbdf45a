// SPDX-License-Identifier: BSD-3-Clause
// What a person reads of scores: the number below a camera's name is that camera's.
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluate/calibration/evaluate_calibration.h"
#include "tests/report/calibration_scores.h"

namespace plumbline {
namespace {

using test::scoreOf;
using ::testing::ElementsAre;

std::vector<std::string> wordsOf(const std::string& line) {
  std::istringstream stream(line);
  return {std::istream_iterator<std::string>(stream), {}};
}

TEST(EvaluationSummary, LooksCamerasUpByName) {
  CalibrationRecord record;
  record.held = HeldCalibration();
  record.held->file = "rig.yaml";
  record.held->scores = {scoreOf("a", {{"left", 1}, {"right", 2}}),
                         scoreOf("b", {{"right", 4}, {"left", 3}}), scoreOf("c", {{"right", 5}})};
  std::istringstream text(evaluationSummary(record));
  std::vector<std::vector<std::string>> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(wordsOf(line));
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_THAT(lines[1], ElementsAre("RMSE", "[px]", "all", "left", "right", "with", "IMU",
                                    "corners", "views"));
  EXPECT_THAT(lines[2], ElementsAre("a", "9.0000", "1.0000", "2.0000", "-", "10", "0"));
  EXPECT_THAT(lines[3], ElementsAre("b", "9.0000", "3.0000", "4.0000", "-", "10", "0"));
  EXPECT_THAT(lines[4], ElementsAre("c", "9.0000", "-", "5.0000", "-", "10", "0"));
}

}  // namespace
}  // namespace plumbline
