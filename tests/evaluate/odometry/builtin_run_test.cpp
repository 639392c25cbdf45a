// SPDX-License-Identifier: BSD-3-Clause
#include <string>

#include <gtest/gtest.h>

#include "evaluate/odometry/run_odometry.h"

namespace plumbline {
namespace {

TEST(TumText, StampsBeforeZeroHaveOneSign) {
  StampedPose pose{-10'000'000, Eigen::Vector3d::Zero(), Eigen::Quaterniond::Identity()};
  EXPECT_NE(tumText({pose}).find("\n-0.010000000 0.0"), std::string::npos) << tumText({pose});
  pose.t = -1'500'000'000;
  EXPECT_NE(tumText({pose}).find("\n-1.500000000 0.0"), std::string::npos) << tumText({pose});
}

// What --estimate was asked for is answered on the terminal, whatever the answer is.
TEST(OdometrySummary, OneLineForAHintOrThatThereIsNone) {
  TrajectoryRecord record;
  TrajectoryRun& run = record.runs.emplace_back();
  run.sequence = "flight", run.calibration = "ours", run.run = 1;
  run.odometry.emplace();
  EXPECT_EQ(odometrySummary(record).find("hint"), std::string::npos) << "not asked for";
  run.odometry->offset_calibrated_s = 0.002;
  run.remarks = {"of something else", "--estimate gives nothing: the flight is too short"};
  EXPECT_NE(odometrySummary(record).find(": none; --estimate gives nothing: the flight is"),
            std::string::npos);
  run.odometry->offset_hint_s = 0.0025;
  run.odometry->offset_hint_std_s = 1e-4;
  EXPECT_NE(odometrySummary(record).find(": t_d 2.500 +- 0.100 ms (used: 2.000)\n"),
            std::string::npos);
  Vector6d change = Vector6d::Zero();
  change[1] = -0.012;
  run.odometry->T_SC0_hint = change;
  EXPECT_NE(odometrySummary(record).find(", T_SC0 changed by 12.0 mm and 0.000 deg\n"),
            std::string::npos);
}

}  // namespace
}  // namespace plumbline
