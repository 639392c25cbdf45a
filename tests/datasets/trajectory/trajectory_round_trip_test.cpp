// SPDX-License-Identifier: BSD-3-Clause
// What is written as TUM is read with the same bits.
#include <fstream>
#include <limits>
#include <random>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "datasets/trajectory/trajectory_reader.h"
#include "tests/datasets/temporary_folder.h"
#include "tests/datasets/trajectory/write_tum.h"

namespace plumbline {
namespace {

std::string writtenText(const std::string& path) {
  std::ostringstream out;
  out << std::ifstream(path).rdbuf();
  return out.str();
}

TEST(WriteTum, WritesSecondsFromTheInteger) {
  Trajectory trajectory;
  trajectory.poses = {{-1'500'000'000, {0.1, -2, 3e-20}, {1, 0, 0, 0}},
                      {1, {0, 0, 0}, {0, 0, 0, 1}},
                      {1403636579763555584, {0, 0, 0}, {0.8, 0.6, 0, 0}}};
  const TemporaryFolder folder;
  writeTum(folder.path("out.txt"), trajectory);
  EXPECT_EQ(writtenText(folder.path("out.txt")),
            "# timestamp [s] tx ty tz qx qy qz qw\n"
            "-1.500000000 0.10000000000000001 -2 3.0000000000000003e-20 0 0 0 1\n"
            "0.000000001 0 0 0 0 0 1 0\n"
            "1403636579.763555584 0 0 0 0.59999999999999998 0 0 0.80000000000000004\n");
}

TEST(WriteTum, RoundTripKeepsEveryBit) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  Trajectory trajectory;
  for (int i = 0; i < 500; ++i) {
    Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
    q.normalize();
    q.coeffs() *= 1 + 1e-4 * normal(random);
    const TimeNs t = 1403636579763555584 + TimeNs{49'999'999} * i;
    trajectory.poses.push_back({t, {normal(random), 1e-9 * normal(random), 1e5}, q});
  }
  const TemporaryFolder folder;
  writeTum(folder.path("out.txt"), trajectory);
  const TrajectoryFile file = readTrajectory(folder.path("out.txt"));
  EXPECT_THAT(file.remarks, testing::IsEmpty());
  ASSERT_EQ(file.trajectory.poses.size(), trajectory.poses.size());
  for (std::size_t i = 0; i < trajectory.poses.size(); ++i) {
    EXPECT_EQ(file.trajectory.poses[i].t, trajectory.poses[i].t);
    EXPECT_EQ(file.trajectory.poses[i].p, trajectory.poses[i].p);
    EXPECT_EQ(file.trajectory.poses[i].q.coeffs(), trajectory.poses[i].q.coeffs());
  }
}

TEST(WriteTum, ReachesTheEndsOfTime) {
  Trajectory trajectory;
  constexpr TimeNs kFarthest = TimeNs{1} << 62;  // 146 years: differences of stamps stay stamps
  trajectory.poses = {{-kFarthest, {0, 0, 0}, {1, 0, 0, 0}}, {kFarthest, {0, 0, 0}, {1, 0, 0, 0}}};
  const TemporaryFolder folder;
  writeTum(folder.path("out.txt"), trajectory);
  const TrajectoryFile file = readTrajectory(folder.path("out.txt"));
  EXPECT_EQ(file.trajectory.poses[0].t, trajectory.poses[0].t);
  EXPECT_EQ(file.trajectory.poses[1].t, trajectory.poses[1].t);
}

}  // namespace
}  // namespace plumbline
