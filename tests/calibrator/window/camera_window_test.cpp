// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/window/camera_window.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/information/covariance.h"
#include "calibrator/initialise/camera_poses.h"
#include "tests/calibrator/window/stereo_frames.h"

namespace plumbline {
namespace {

using test::StereoFrames;
using test::stereoFrames;

CameraWindow windowAt(const StereoFrames& frames, int first, int count,
                      const CameraWindowOptions& options) {
  CameraWindow window(frames.simulated.session.target, frames.simulated.truth.cameras, options);
  for (int i = first; i < first + count; ++i) {
    const auto f = static_cast<std::size_t>(i);
    window.add(frames.corners[f], frames.T_FC0[f]);
  }
  return window;
}

CameraWindowOptions tight(double cauchy_px = 0) {
  CameraWindowOptions options;
  options.cauchy_px = cauchy_px;
  options.pixel_sigma = 0.3;
  options.tolerance = 1e-9;
  return options;
}

/// Cameras at a displacement in their tangents.
CameraEstimate movedCameras(const CameraEstimate& from, const Eigen::VectorXd& d) {
  const CameraLayout layout(from.intrinsics);
  CameraEstimate to = from;
  for (std::size_t c = 0; c < to.intrinsics.size(); ++c) {
    to.intrinsics[c].setStacked(from.intrinsics[c].stacked() +
                                d.segment(layout.intrinsics[c], layout.intrinsics_size[c]));
    if (c > 0) to.T_C0Ci[c] = boxplus(from.T_C0Ci[c], d.segment<6>(layout.T_C0Ci[c]));
  }
  return to;
}

/// Cost of one frame at given cameras with its own pose at its best: what a prior stands for.
double bestCost(const StereoFrames& frames, std::size_t f, const CameraEstimate& cameras,
                const CameraWindowOptions& options) {
  std::vector<PackedCorners> packed;
  std::vector<FrameView> views;
  for (std::size_t c = 0; c < cameras.intrinsics.size(); ++c) {
    packed.emplace_back(frames.simulated.session.target,
                        std::vector<ImageView>{{0, frames.corners[f][c]}});
  }
  for (std::size_t c = 0; c < cameras.intrinsics.size(); ++c) {
    views.push_back({&cameras.intrinsics[c], packed[c].view(0), cameras.T_C0Ci[c].inverse()});
  }
  PoseRefinementOptions refine;
  refine.gram = {options.cauchy_px, 0};
  refine.max_iterations = 200;
  refine.tolerance = 1e-12;
  const PoseRefinement at = refinePose(views, frames.T_FC0[f].inverse(), refine);
  return 0.5 * at.cost / (options.pixel_sigma * options.pixel_sigma);
}

/// One standard deviation of each parameter given the others, as the prior has it, with its sign
/// and size varied.
Eigen::VectorXd direction(const QuadraticCost& prior, int which) {
  Eigen::VectorXd d = prior.H.diagonal().cwiseSqrt().cwiseInverse();
  for (Eigen::Index i = 0; i < d.size(); ++i) d(i) *= std::sin(1.0 + 3.7 * which + 1.3 * i);
  return d;
}

class PriorOfADroppedFrame : public ::testing::TestWithParam<double> {};

TEST_P(PriorOfADroppedFrame, HasItsCostAndGradientAtTheLinearisationPoint) {
  const StereoFrames frames = stereoFrames(3, 3, 2, 0.3);
  const CameraWindowOptions options = tight(GetParam());
  CameraWindow window = windowAt(frames, 0, 5, options);
  ASSERT_TRUE(window.solve());
  const CameraEstimate at = window.estimate();
  window.marginaliseOldest();
  const QuadraticCost prior = window.priorAt(at);
  EXPECT_NEAR(prior.c, bestCost(frames, 0, at, options), 1e-7 * prior.c);
  for (int which = 0; which < 8; ++which) {
    const Eigen::VectorXd d = 1e-3 * direction(prior, which);
    const double slope = 0.5 * (bestCost(frames, 0, movedCameras(at, d), options) -
                                bestCost(frames, 0, movedCameras(at, -d), options));
    // In units of what a standard deviation changes.
    EXPECT_NEAR(slope / 1e-3, prior.b.dot(d) / 1e-3, 2e-4) << which;
  }
  EXPECT_GT(prior.b.dot(prior.H.ldlt().solve(prior.b)), 1e-2);  // a gradient worth comparing
}

INSTANTIATE_TEST_SUITE_P(SquaredAndCauchy, PriorOfADroppedFrame, ::testing::Values(0.0, 1.0));

TEST(CameraWindow, PriorAgreesNearbyToSecondOrder) {
  // Exact corners: the cost is 0.5 d'H d there, and what is left out is of third order.
  const StereoFrames frames = stereoFrames(3, 3, 2, 0);
  const CameraWindowOptions options = tight();
  CameraWindow window = windowAt(frames, 0, 5, options);
  const CameraEstimate at = window.estimate();
  window.marginaliseOldest();
  const QuadraticCost prior = window.priorAt(at);
  EXPECT_LT(prior.c, 1e-15);
  for (int which = 0; which < 8; ++which) {
    const auto difference = [&](double scale) {
      const Eigen::VectorXd d = scale * direction(prior, which);
      const CameraEstimate there = movedCameras(at, d);
      return std::abs(bestCost(frames, 0, there, options) - window.priorAt(there).c);
    };
    const Eigen::VectorXd d = 16 * direction(prior, which);
    EXPECT_LT(difference(16), 0.05 * window.priorAt(movedCameras(at, d)).c) << which;
    EXPECT_GT(difference(16) / difference(8), 6) << which;  // 8 for third order
  }
}

TEST(CameraWindow, MarginalisingLosesNothingWhereItStands) {
  const StereoFrames frames = stereoFrames(4, 4, 2, 0.3);
  for (const double cauchy_px : {0.0, 1.0}) {
    CameraWindow window = windowAt(frames, 0, 8, tight(cauchy_px));
    ASSERT_TRUE(window.solve());
    const Eigen::MatrixXd before = window.information();
    const CameraEstimate at = window.estimate();
    window.marginaliseOldest();
    window.marginaliseOldest();
    EXPECT_EQ(window.frameCount(), 6);
    const Eigen::VectorXd scale = before.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd difference =
        scale.asDiagonal() * (window.information() - before) * scale.asDiagonal();
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-9);
    ASSERT_TRUE(window.solve());  // and the minimum is where it was
    const Eigen::VectorXd moved =
        window.estimate().intrinsics[0].stacked() - at.intrinsics[0].stacked();
    const Eigen::VectorXd std = covarianceOf(before)->diagonal().head(8).cwiseSqrt();
    EXPECT_LT(moved.cwiseQuotient(std).cwiseAbs().maxCoeff(), 1e-6);
  }
}

TEST(CameraWindow, RemovedFrameLeavesNoTrace) {
  const StereoFrames frames = stereoFrames(5, 4, 2, 0.3);
  CameraWindow with = windowAt(frames, 0, 6, tight());
  CameraWindow without = windowAt(frames, 0, 5, tight());
  ASSERT_TRUE(with.solve());
  with.remove(5);
  ASSERT_TRUE(with.solve());
  ASSERT_TRUE(without.solve());
  const Eigen::MatrixXd expected = without.information();
  EXPECT_LT((with.information() - expected).cwiseAbs().maxCoeff(),
            1e-6 * expected.cwiseAbs().maxCoeff());
  EXPECT_NEAR(*with.rmsePx(), *without.rmsePx(), 1e-8);
  EXPECT_NEAR(*with.rmsePx(), 0.3 * std::sqrt(2), 0.03);
}

TEST(CameraWindow, HoldsFramesThatOneCameraMissed) {
  StereoFrames frames = stereoFrames(6, 4, 2, 0.3);
  for (std::size_t f = 0; f < 8; f += 2) frames.corners[f][f % 4 == 0 ? 0 : 1].clear();
  CameraWindow window = windowAt(frames, 0, 8, tight());
  ASSERT_TRUE(window.solve());
  const Eigen::MatrixXd before = window.information();
  for (int i = 0; i < 4; ++i) window.marginaliseOldest();
  EXPECT_LT((window.information() - before).norm(), 1e-9 * before.norm());
}

TEST(CameraWindow, FrameWithoutPoseIsForgotten) {
  StereoFrames frames = stereoFrames(7, 4, 2, 0.3);
  CameraWindow window = windowAt(frames, 0, 5, tight());
  ASSERT_TRUE(window.solve());
  const Eigen::MatrixXd before = window.information();
  std::vector<std::vector<Corner>> one_corner(2);
  one_corner[0] = {frames.corners[0][0].front()};
  window.add(one_corner, frames.T_FC0[0]);
  for (int i = 0; i < 6; ++i) window.marginaliseOldest();
  EXPECT_EQ(window.frameCount(), 0);
  EXPECT_FALSE(window.rmsePx().has_value());
  EXPECT_LT((window.information() - before).norm(), 1e-9 * before.norm());
}

TEST(CameraWindow, EstimateStaysWhereTheWindowDoesNotSolve) {
  const StereoFrames frames = stereoFrames(8, 4, 2, 0.3);
  CameraWindowOptions options = tight();
  options.max_iterations = 1;  // too few
  CameraWindow window(frames.simulated.session.target, frames.simulated.truth.cameras, options);
  for (std::size_t f = 0; f < 4; ++f) window.add(frames.corners[f], frames.T_FC0[f]);
  const Eigen::VectorXd before = window.estimate().intrinsics[0].stacked();
  EXPECT_FALSE(window.solve());
  EXPECT_EQ(window.estimate().intrinsics[0].stacked(), before);
}

TEST(CameraWindow, IsCloseToTheBatch) {
  const StereoFrames frames = stereoFrames(9, 12, 5, 0.3);
  CameraStageOptions batch_options;
  batch_options.cauchy_px = 0;
  batch_options.pixel_sigma = 0.3;
  const auto batch = calibrateCameras(frames.simulated.session, batch_options);
  ASSERT_TRUE(batch.ok());
  CameraWindowOptions options;
  options.cauchy_px = 0;
  options.pixel_sigma = 0.3;
  CameraWindow window(frames.simulated.session.target, batch->cameras, options);
  for (std::size_t f = 0; f < frames.corners.size(); ++f) {
    window.add(frames.corners[f], frames.T_FC0[f]);
    if (window.frameCount() < 5) continue;
    ASSERT_TRUE(window.solve()) << f;
    while (window.frameCount() > options.size) window.marginaliseOldest();
  }
  const Eigen::VectorXd std = batch->summary.covariance.standardDeviations();
  const Eigen::VectorXd d = cameraDifference(window.cameras(), batch->cameras);
  EXPECT_LT(d.cwiseQuotient(std).cwiseAbs().maxCoeff(), 0.2);
  const auto entropy = entropyNats(window.information());
  ASSERT_TRUE(entropy.has_value());
  EXPECT_NEAR(*entropy, batch->summary.entropy_nats, 0.05);
}

}  // namespace
}  // namespace plumbline
