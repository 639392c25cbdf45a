// SPDX-License-Identifier: BSD-3-Clause
// Wrong orders, and what must not be taken for one: inverted quaternions, another body, noise.
#include "evaluate/metrics/trajectory/quaternion_order.h"

#include <gtest/gtest.h>

#include "tests/calibrator/simulate/sampled_trajectory.h"

namespace plumbline {
namespace {

// What a reader of x y z w makes of a file that has w x y z.
Eigen::Quaterniond misread(const Eigen::Quaterniond& q) {
  Eigen::Quaterniond read;
  read.x() = q.w();
  read.y() = q.x();
  read.z() = q.y();
  read.w() = q.z();
  return read;
}

std::vector<PosePair> pairs(MotionKind kind = MotionKind::kFull) {
  TrajectoryOptions motion;
  motion.kind = kind;
  const AnalyticTrajectory trajectory(AprilGrid{}, simulatedRig("euroc"), motion);
  SamplingOptions estimate, truth;
  estimate.sigma_m = 0.01;
  estimate.sigma_rad = 0.01;
  truth.T_WF = {expSO3({0.2, -1, 2}), {1, 2, 3}};
  truth.T_SB = {expSO3({1, 0.4, -0.6}), {0.02, 0, 0.01}};
  const Trajectory a = sampled(trajectory, estimate), b = sampled(trajectory, truth);
  std::vector<PosePair> result;
  for (std::size_t i = 0; i < a.poses.size(); ++i) result.push_back({a.poses[i], b.poses[i]});
  return result;
}

TEST(QuaternionOrder, FromWFirstUndoesTheMisreading) {
  const Eigen::Quaterniond q(0.1, 0.2, 0.3, 0.4);
  EXPECT_EQ(fromWFirst(misread(q)).coeffs(), q.coeffs());
}

TEST(QuaternionOrder, RelativeAnglesAloneCannotTell) {
  const auto p = pairs();
  const auto& a = p[0].estimate.q;
  const auto& b = p[50].estimate.q;
  EXPECT_NEAR(a.angularDistance(b), misread(a).angularDistance(misread(b)), 1e-12);
  EXPECT_GT(a.angularDistance(b), 0.1);
}

TEST(QuaternionOrder, TheMisreadSideIsFound) {
  auto estimate = pairs(), truth = pairs();
  for (PosePair& pair : estimate) pair.estimate.q = misread(pair.estimate.q);
  for (PosePair& pair : truth) pair.truth.q = misread(pair.truth.q);
  const auto first = quaternionOrderFault(estimate), second = quaternionOrderFault(truth);
  ASSERT_TRUE(first);
  EXPECT_TRUE(first->estimate);
  EXPECT_FALSE(first->truth);
  EXPECT_LT(first->reordered_deg, 2);
  EXPECT_GT(first->as_read_deg, 10);
  ASSERT_TRUE(second);
  EXPECT_TRUE(second->truth);
  EXPECT_FALSE(second->estimate);
}

TEST(QuaternionOrder, RightOrderOtherBodyAndInversionAreNoFault) {
  EXPECT_FALSE(quaternionOrderFault(pairs()));
  auto inverted = pairs();
  for (PosePair& pair : inverted) pair.estimate.q = pair.estimate.q.conjugate();
  EXPECT_FALSE(quaternionOrderFault(inverted));
  EXPECT_FALSE(quaternionOrderFault(pairs(MotionKind::kStatic)));
  EXPECT_FALSE(quaternionOrderFault({}));
}

}  // namespace
}  // namespace plumbline
