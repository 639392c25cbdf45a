// SPDX-License-Identifier: BSD-3-Clause
// Differences of cameras stand in the order of the camera stage's covariance.
#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/simulate/rig.h"

namespace plumbline {
namespace {

TEST(CameraDifference, ListsIntrinsicsThenTangentsOfAllButTheFirst) {
  const std::vector<CameraCalibration> from = simulatedRig("euroc").calibration.cameras;
  ASSERT_EQ(from.size(), 2U);
  std::vector<CameraCalibration> to = from;
  Vector6d step;
  step << 0.01, 0.02, 0.03, 1e-3, 2e-3, 3e-3;
  to[1].T_C0Ci = boxplus(from[1].T_C0Ci, step);
  to[0].T_C0Ci.t.x() += 5;  // camera 0 is the frame: its pose is no parameter
  to[1].intrinsics.projection[0] += 7;
  const Eigen::VectorXd d = cameraDifference(to, from);
  const Eigen::Index each = from[0].intrinsics.stacked().size();
  ASSERT_EQ(d.size(), 2 * each + 6);
  EXPECT_TRUE(d.head(each).isZero());
  EXPECT_NEAR(d[each], 7, 1e-9);
  EXPECT_TRUE(d.segment(each + 1, each - 1).isZero());
  EXPECT_TRUE(d.tail<6>().isApprox(step, 1e-9));
}

TEST(CameraDifference, EndsWithTheBoardsTermsWhereTheyAreEstimated) {
  const std::vector<CameraCalibration> cameras = simulatedRig("euroc").calibration.cameras;
  CameraEstimate from = estimateOf(cameras);
  CameraEstimate to = from;
  from.target = TargetTerms::Constant(1e-3);
  to.target = TargetTerms::Constant(3e-3);
  to.intrinsics[0].projection[2] += 2;
  const Eigen::VectorXd d = cameraDifference(to, from);
  const CameraLayout layout(from);
  ASSERT_EQ(d.size(), layout.size);
  EXPECT_NEAR(d[2], 2, 1e-9);
  EXPECT_TRUE(d.tail<kTargetTerms>().isApproxToConstant(2e-3, 1e-12));
  EXPECT_NEAR(d.norm(), std::hypot(d[2], d.tail<kTargetTerms>().norm()), 1e-12);
}

}  // namespace
}  // namespace plumbline
