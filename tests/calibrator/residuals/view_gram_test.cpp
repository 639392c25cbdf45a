// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/residuals/view_gram.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/camera/camera_dispatch.h"
#include "calibrator/residuals/plain_gram.h"
#include "tests/calibrator/camera/example_cameras.h"
#include "tests/calibrator/residuals/available_sets.h"
#include "tests/calibrator/residuals/example_view.h"
#include "tests/calibrator/residuals/naive_gram.h"

namespace plumbline {
namespace {

using test::naiveGram;
using test::NaiveGram;

const AprilGrid kViewTarget;

// Options that take every path of the kernel.
std::vector<GramOptions> allOptions() {
  return {{.cauchy_px = 0},
          {.cauchy_px = 1.5, .triggs_clamp = 0},
          {.cauchy_px = 1.5, .triggs_clamp = 0.7},
          {.cauchy_px = 0.2, .triggs_clamp = 0.95},
          {.cauchy_px = 1.5, .triggs_clamp = 2}};
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
  const Transform T_CF = test::examplePose();
  for (const Intrinsics& camera : test::allCameras()) {
    const ImageView view = test::noisyView(kViewTarget, camera, T_CF, 144, 2.0, 1);
    ASSERT_EQ(view.corners.size(), 144U);
    const PackedCorners corners(kViewTarget, {view});
    for (const GramOptions& options : allOptions()) {
      const NaiveGram naive = naiveGram(camera, T_CF, kViewTarget, corners.view(0), options);
      for (InstructionSet set : test::availableSets()) {
        expectEqual(viewGram(camera, T_CF, corners.view(0), options, set), naive);
      }
    }
  }
}

TEST(ViewGram, DoesNotCountPaddingNorRejectedCorners) {
  const Transform T_CF = test::examplePose();
  for (const Intrinsics& camera : test::allCameras()) {
    for (int count : {1, 4, 7, 8, 9, 47, 48, 49, 97}) {
      const ImageView view = test::noisyView(kViewTarget, camera, T_CF, count, 1.0, count);
      PackedCorners corners(kViewTarget, {view});
      if (count > 5) corners.setWeight(0, 3, 0);
      for (const GramOptions& options : allOptions()) {
        const ViewGram gram = viewGram(camera, T_CF, corners.view(0), options);
        const NaiveGram naive = naiveGram(camera, T_CF, kViewTarget, corners.view(0), options);
        EXPECT_LT(scaledDifference(assembled(gram), naive.H), 1e-12) << count << " corners";
        EXPECT_NEAR(gram.cost, naive.cost, 1e-11 * naive.cost) << count << " corners";
      }
    }
  }
}

TEST(ViewGram, PoseOnlyAndCostOnlyAreItsParts) {
  const Transform T_CF = test::examplePose();
  for (const Intrinsics& camera : test::allCameras()) {
    const ImageView view = test::noisyView(kViewTarget, camera, T_CF, 101, 1.0, 3);
    const PackedCorners corners(kViewTarget, {view});
    for (const GramOptions& options : allOptions()) {
      for (InstructionSet set : test::availableSets()) {
        const ViewGram whole = viewGram(camera, T_CF, corners.view(0), options, set);
        const PoseGram pose = poseGram(camera, T_CF, corners.view(0), options, set);
        const double cost = viewCost(camera, T_CF, corners.view(0), options, set);
        EXPECT_TRUE(pose.H.isApprox(whole.H, 1e-13));
        EXPECT_TRUE(pose.b.isApprox(whole.b, 1e-11));
        EXPECT_DOUBLE_EQ(pose.squared_error, whole.squared_error);
        EXPECT_NEAR(pose.cost, whole.cost, 1e-13 * whole.cost);
        EXPECT_NEAR(cost, whole.cost, 1e-13 * whole.cost);
      }
    }
  }
}

TEST(ViewGram, ThePlainWayEqualsTheKernel) {
  const Transform T_CF = test::examplePose();
  for (const Intrinsics& camera : test::allCameras()) {
    const ImageView view = test::noisyView(kViewTarget, camera, T_CF, 101, 1.0, 3);
    PackedCorners corners(kViewTarget, {view});
    corners.setWeight(0, 7, 0);
    const AnyCameraModel model = cameraModelOf(camera);
    for (const InstructionSet set : {InstructionSet::kBaseline, bestInstructionSet()}) {
      for (const GramOptions& options : allOptions()) {
        const ViewGram kernel = viewGram(camera, T_CF, corners.view(0), options);
        const PackedView packed = corners.view(0);
        const plain::View in{set, camera, T_CF, packed, options};
        ViewGram plain;
        PoseGram pose;
        std::visit(
            [&]<class Model>(Model) {
              plain::Version<Model>::view(in, plain);
              plain::Version<Model>::pose(in, pose);
            },
            model);
        EXPECT_LT(scaledDifference(assembled(kernel), assembled(plain)), 1e-12);
        EXPECT_TRUE(gradient(plain).isApprox(gradient(kernel), 1e-10));
        EXPECT_TRUE(pose.H.isApprox(kernel.H, 1e-12));
        EXPECT_NEAR(plain.cost, kernel.cost, 1e-12 * kernel.cost);
        EXPECT_NEAR(plain.squared_error, kernel.squared_error, 1e-12 * kernel.squared_error);
        EXPECT_NEAR(pose.cost, kernel.cost, 1e-12 * kernel.cost);
      }
      Transform behind = T_CF;
      behind.t.z() = -1.1;
      const PackedView packed = corners.view(0);
      const GramOptions options;
      const plain::View in{set, camera, behind, packed, options};
      EXPECT_EQ(
          std::visit([&]<class Model>(Model) { return plain::Version<Model>::cost(in); }, model),
          100 * kInvalidSquaredError);
    }
  }
}

TEST(ViewGram, HasTheGradientOfItsCostForEveryModel) {
  const Transform T_CF = test::examplePose();
  const GramOptions options{.cauchy_px = 1.5, .triggs_clamp = 0};
  for (const Intrinsics& camera : test::everyModel()) {
    const ImageView view = test::noisyView(kViewTarget, camera, T_CF, 60, 1.0, 3);
    ASSERT_GT(view.corners.size(), 40U);
    const PackedCorners corners(kViewTarget, {view});
    const ViewGram gram = viewGram(camera, T_CF, corners.view(0), options);
    const Eigen::VectorXd k = camera.stacked();
    ASSERT_EQ(gram.b_k.size(), k.size());
    for (Eigen::Index i = 0; i < k.size(); ++i) {
      const auto costAt = [&](double step) {
        Intrinsics moved = camera;
        moved.setStacked(k + step * Eigen::VectorXd::Unit(k.size(), i));
        return viewCost(moved, T_CF, corners.view(0), options);
      };
      // rho' weighs the gradient of rho(|e|^2), twice that of the halves that b sums.
      const double slope = (costAt(1e-5) - costAt(-1e-5)) / 2e-5;
      EXPECT_NEAR(2 * gram.b_k[i], slope, 1e-5 * std::sqrt(gram.H_k(i, i) * gram.cost))
          << toString(camera.projection_model) << " " << i;
    }
    EXPECT_NEAR(viewCost(camera, T_CF, corners.view(0), options), gram.cost, 1e-13 * gram.cost);
  }
}

// A view of which every corner is charged, and no derivative remains.
void expectCharged(const ViewGram& gram, double corners) {
  EXPECT_EQ(gram.cost, corners * kInvalidSquaredError);
  EXPECT_EQ(gram.squared_error, corners * kInvalidSquaredError);
  EXPECT_TRUE(gram.H.isZero(0) && gram.b.isZero(0) && gram.H_pose_k.isZero(0) &&
              gram.H_k.isZero(0) && gram.b_k.isZero(0));
}

TEST(ViewGram, ATargetBehindTheCameraCostsMuchAndHasNoGradient) {
  Transform behind = test::examplePose();
  behind.t.z() = -1.1;
  for (const Intrinsics& camera : test::allCameras()) {
    const ImageView view = test::noisyView(kViewTarget, camera, test::examplePose(), 21, 1.0, 3);
    const PackedCorners corners(kViewTarget, {view});
    for (const GramOptions& options : allOptions()) {
      for (InstructionSet set : test::availableSets()) {
        expectCharged(viewGram(camera, behind, corners.view(0), options, set), 21);
        EXPECT_EQ(viewCost(camera, behind, corners.view(0), options, set),
                  21 * kInvalidSquaredError);
      }
    }
  }
}

TEST(ViewGram, ParametersThatAreNotFiniteAreChargedToo) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Intrinsics good = test::radtanCamera();
  const ImageView view = test::noisyView(kViewTarget, good, test::examplePose(), 21, 1.0, 3);
  PackedCorners corners(kViewTarget, {view});
  corners.setWeight(0, 4, 0);
  Intrinsics camera = good;
  camera.distortion[1] = nan;
  Transform T_CF = test::examplePose();
  T_CF.t.x() = nan;
  for (const GramOptions& options : allOptions()) {
    expectCharged(viewGram(camera, test::examplePose(), corners.view(0), options), 20);
    expectCharged(viewGram(good, T_CF, corners.view(0), options), 20);
    EXPECT_EQ(viewCost(good, T_CF, corners.view(0), options), 20 * kInvalidSquaredError);
    EXPECT_EQ(poseGram(camera, T_CF, corners.view(0), options).cost, 20 * kInvalidSquaredError);
  }
}

TEST(ViewGram, OneCornerBehindTheCameraLeavesTheOthersAsTheyAre) {
  // The target stands across the camera's plane: its far columns lie behind.
  const Transform T_CF(expSO3({0, 1.4, 0}), Eigen::Vector3d(0.3, -0.4, 0.6));
  for (const Intrinsics& camera : test::allCameras()) {
    ImageView view;
    int behind = 0;
    for (int id = 0; id < kViewTarget.cornerCount(); ++id) {
      const Eigen::Vector2d p_F = kViewTarget.corner(id);
      const Eigen::Vector3d p_C = T_CF * Eigen::Vector3d(p_F.x(), p_F.y(), 0);
      const auto uv = project(camera, p_C);
      if (p_C.z() > 0 && !uv) continue;  // beyond the fold: neither here nor there
      behind += uv ? 0 : 1;
      view.corners.push_back({id, uv ? *uv : Eigen::Vector2d(1, 1)});
    }
    ASSERT_GT(behind, 5);
    ASSERT_GT(static_cast<int>(view.corners.size()) - behind, 20);
    PackedCorners corners(kViewTarget, {view});
    const ViewGram all = viewGram(camera, T_CF, corners.view(0));
    for (std::size_t i = 0; i < view.corners.size(); ++i) {
      if (view.corners[i].uv == Eigen::Vector2d(1, 1)) {
        corners.setWeight(0, static_cast<int>(i), 0);
      }
    }
    const ViewGram rest = viewGram(camera, T_CF, corners.view(0));
    EXPECT_EQ(assembled(all), assembled(rest));
    EXPECT_EQ(all.cost, rest.cost + behind * kInvalidSquaredError);
  }
}

TEST(ViewGram, CauchyWeighsAnErrorOfOneScaleByHalf) {
  // All corners are off by exactly c along u: slope 1/2, cost c^2 log 2 each.
  const double c = 1.5;
  const Intrinsics camera = test::radtanCamera();
  const Transform T_CF = test::examplePose();
  ImageView view = test::noisyView(kViewTarget, camera, T_CF, 30, 0, 1);
  const PackedCorners exact(kViewTarget, {view});
  for (Corner& corner : view.corners) corner.uv.x() -= c;
  const PackedCorners shifted(kViewTarget, {view});
  const GramOptions reweighted{.cauchy_px = c, .triggs_clamp = 0};
  const ViewGram gram = viewGram(camera, T_CF, shifted.view(0), reweighted);
  EXPECT_NEAR(gram.cost, 30 * c * c * std::log(2.0), 1e-10);
  EXPECT_NEAR(gram.squared_error, 30 * c * c, 1e-10);
  EXPECT_NEAR(gram.b_k[2], 30 * c / 2, 1e-10);  // principal point: the sum of the errors
  EXPECT_TRUE(gram.H.isApprox(viewGram(camera, T_CF, exact.view(0)).H / 2, 1e-12));
  // At one scale the second derivative of the loss vanishes along e: only the clamp remains.
  const GramOptions clamped{.cauchy_px = c, .triggs_clamp = 0.7};
  EXPECT_NEAR(viewGram(camera, T_CF, shifted.view(0), clamped).H_k(2, 2), 30 * 0.3 / 2, 1e-10);
}

TEST(ViewGram, AnEmptyViewIsZero) {
  const PackedCorners corners(kViewTarget, {ImageView{}});
  for (const GramOptions& options : allOptions()) {
    expectCharged(viewGram(test::radtanCamera(), test::examplePose(), corners.view(0), options), 0);
  }
}

}  // namespace
}  // namespace plumbline
