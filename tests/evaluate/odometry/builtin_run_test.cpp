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

}  // namespace
}  // namespace plumbline
