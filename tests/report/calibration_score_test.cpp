// SPDX-License-Identifier: BSD-3-Clause
// Scores of sessions that order their cameras otherwise, or lack one: looked up by name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/records/calibration_record.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;

CalibrationScore scoreOf(const std::vector<std::pair<std::string, double>>& cameras) {
  CalibrationScore score;
  for (const auto& [name, rmse_px] : cameras) {
    score.cameras.push_back(name);
    score.per_camera.push_back({});
    score.per_camera.back().rmse_px = rmse_px;
  }
  return score;
}

TEST(CalibrationScores, HaveTheirCamerasByName) {
  const CalibrationScore turned = scoreOf({{"right", 2}, {"left", 1}});
  ASSERT_NE(errorsOf(turned, "left"), nullptr);
  EXPECT_EQ(errorsOf(turned, "left")->rmse_px, 1);
  EXPECT_EQ(errorsOf(turned, "right")->rmse_px, 2);
  EXPECT_EQ(errorsOf(turned, "third"), nullptr);
}

TEST(CalibrationScores, NameEveryCameraOnceThoughTheFirstHasNone) {
  CalibrationScore failed;  // no pose was found: no cameras, no errors
  failed.problem = "no frame has a pose";
  EXPECT_THAT(cameraNames({failed, scoreOf({{"left", 1}}), scoreOf({{"right", 2}, {"left", 1}})}),
              ElementsAre("left", "right"));
}

TEST(CalibrationScores, OfACameraWithoutErrorsAreNone) {
  CalibrationScore score;
  score.cameras = {"left"};
  EXPECT_EQ(errorsOf(score, "left"), nullptr);
  // Nor has a name that is not among them those of the first camera without one.
  score.per_camera.resize(2);
  EXPECT_EQ(errorsOf(score, "right"), nullptr);
}

}  // namespace
}  // namespace plumbline
