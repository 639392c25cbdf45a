// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/residuals/view_gram.h"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/residuals/instruction_set.h"
#include "tests/calibrator/camera/example_cameras.h"
#include "tests/calibrator/residuals/example_view.h"
#include "tests/calibrator/residuals/naive_gram.h"

namespace plumbline {
namespace {

using testing::naiveGram;
using testing::NaiveGram;

const AprilGrid kTarget;

// Options that take every path of the kernel.
std::vector<GramOptions> allOptions() {
  return {{.cauchy_px = 0},
          {.cauchy_px = 1.5, .triggs_clamp = 0},
          {.cauchy_px = 1.5, .triggs_clamp = 0.7},
          {.cauchy_px = 0.2, .triggs_clamp = 0.95}};
}

std::vector<InstructionSet> availableSets() {
  std::vector<InstructionSet> sets{InstructionSet::kBaseline};
  if (isAvailable(InstructionSet::kAvx2)) sets.push_back(InstructionSet::kAvx2);
  return sets;
}

Eigen::Matrix<double, 14, 14> assembled(const ViewGram& gram) {
  Eigen::Matrix<double, 14, 14> H;
  H << gram.H, gram.H_pose_k, gram.H_pose_k.transpose(), gram.H_k;
  return H;
}

Eigen::Matrix<double, 14, 1> gradient(const ViewGram& gram) {
  Eigen::Matrix<double, 14, 1> b;
  b << gram.b, gram.b_k;
  return b;
}

// Largest entry of a - b, relative to the scale of each entry's row and column in H.
double scaledDifference(const Eigen::Matrix<double, 14, 14>& a,
                        const Eigen::Matrix<double, 14, 14>& b) {
  const Eigen::Matrix<double, 14, 1> scale = b.diagonal().cwiseSqrt().cwiseInverse();
  return (scale.asDiagonal() * (a - b) * scale.asDiagonal()).cwiseAbs().maxCoeff();
}

void expectEqual(const ViewGram& gram, const NaiveGram& naive) {
  const Eigen::Matrix<double, 14, 1> scale = naive.H.diagonal().cwiseSqrt().cwiseInverse();
  const double error = std::sqrt(naive.cost);
  EXPECT_LT(scaledDifference(assembled(gram), naive.H), 1e-12);
  EXPECT_LT((scale.asDiagonal() * (gradient(gram) - naive.b)).cwiseAbs().maxCoeff(), 1e-11 * error);
  EXPECT_NEAR(gram.cost, naive.cost, 1e-11 * naive.cost);
  EXPECT_NEAR(gram.squared_error, naive.squared_error, 1e-11 * naive.squared_error);
}

TEST(ViewGram, EqualsTheSumOverCornersForEveryModelLossAndInstructionSet) {
  const Transform T_CF = testing::examplePose();
  for (const Intrinsics& camera : testing::allCameras()) {
    const ImageView view = testing::noisyView(kTarget, camera, T_CF, 144, 2.0, 1);
    ASSERT_EQ(view.corners.size(), 144U);
    const PackedCorners corners(kTarget, {view});
    for (const GramOptions& options : allOptions()) {
      const NaiveGram naive = naiveGram(camera, T_CF, kTarget, corners.view(0), options);
      for (InstructionSet set : availableSets()) {
        expectEqual(viewGramWith(set, camera, T_CF, corners.view(0), options), naive);
      }
    }
  }
}

TEST(ViewGram, DoesNotCountPaddingNorRejectedCorners) {
  const Transform T_CF = testing::examplePose();
  for (const Intrinsics& camera : testing::allCameras()) {
    for (int count : {1, 4, 7, 8, 9, 47, 48, 49, 97}) {
      const ImageView view = testing::noisyView(kTarget, camera, T_CF, count, 1.0, count);
      PackedCorners corners(kTarget, {view});
      if (count > 5) corners.setWeight(0, 3, 0);
      for (const GramOptions& options : allOptions()) {
        const ViewGram gram = viewGram(camera, T_CF, corners.view(0), options);
        const NaiveGram naive = naiveGram(camera, T_CF, kTarget, corners.view(0), options);
        EXPECT_LT(scaledDifference(assembled(gram), naive.H), 1e-12) << count << " corners";
        EXPECT_NEAR(gram.cost, naive.cost, 1e-11 * naive.cost) << count << " corners";
      }
    }
  }
}

TEST(ViewGram, PoseOnlyAndCostOnlyAreItsParts) {
  const Transform T_CF = testing::examplePose();
  for (const Intrinsics& camera : testing::allCameras()) {
    const ImageView view = testing::noisyView(kTarget, camera, T_CF, 101, 1.0, 3);
    const PackedCorners corners(kTarget, {view});
    for (const GramOptions& options : allOptions()) {
      for (InstructionSet set : availableSets()) {
        const ViewGram whole = viewGramWith(set, camera, T_CF, corners.view(0), options);
        const PoseGram pose = poseGramWith(set, camera, T_CF, corners.view(0), options);
        const double cost = viewCostWith(set, camera, T_CF, corners.view(0), options);
        EXPECT_TRUE(pose.H.isApprox(whole.H, 1e-13));
        EXPECT_TRUE(pose.b.isApprox(whole.b, 1e-11));
        EXPECT_DOUBLE_EQ(pose.squared_error, whole.squared_error);
        EXPECT_NEAR(pose.cost, whole.cost, 1e-13 * whole.cost);
        EXPECT_NEAR(cost, whole.cost, 1e-13 * whole.cost);
      }
    }
  }
}

}  // namespace
}  // namespace plumbline
