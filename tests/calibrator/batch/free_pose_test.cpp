// SPDX-License-Identifier: BSD-3-Clause
// A frame of one or two corners of one camera, which some pose always explains: it says nothing of
// cameras and board.
#include <array>
#include <memory>

#include <gtest/gtest.h>

#include "calibrator/batch/board/higher_terms.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/information.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/dense/decompositions.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

constexpr std::size_t kBareFrame = 20;

/// A calibrated recording, of one frame of which each camera has only so many corners left; about
/// the optimum, with the board's terms.
class FreePose : public ::testing::TestWithParam<std::array<std::size_t, 2>> {
 protected:
  void SetUp() override {
    SimulationOptions options;
    options.duration_s = 12;
    options.camera_rate_hz = 5;
    const SimulatedSession s = simulateSession(simulatedRig("euroc"), options);
    const auto result = calibrateCameras(s.session);
    ASSERT_TRUE(result.ok()) << result.failure();
    const Frame& bare = result->frames[kBareFrame];
    for (std::size_t c = 0; c < 2; ++c) {
      std::vector<ImageView> views = s.session.cameras[c].views;
      ASSERT_GE(bare.view[c], 0);
      views[static_cast<std::size_t>(bare.view[c])].corners.resize(GetParam()[c]);
      corners_.emplace_back(s.session.target, views);
    }
    problem_.corners = corners_;
    problem_.frames = result->frames;
    problem_.gram = {1, 0};
    problem_.target = std::make_shared<TargetModel>(s.session.target);
    problem_.weights.assign(result->frames.size(), 1);
    estimate_ = estimateOf(result->cameras, result->T_FC0);
    estimate_.target = TargetTerms::Zero();
    without_ = problem_;
    without_.weights[kBareFrame] = 0;
  }

  std::vector<PackedCorners> corners_;
  CameraProblem problem_;
  CameraProblem without_;  ///< the frame counts for nothing
  CameraEstimate estimate_;
};

/// The largest difference, over the roots of what of rows and columns is known without the frame.
double difference(const Eigen::MatrixXd& with, const Eigen::MatrixXd& without,
                  const Eigen::VectorXd& rows, const Eigen::VectorXd& columns) {
  const Eigen::MatrixXd scaled = rows.cwiseSqrt().cwiseInverse().asDiagonal() * (with - without) *
                                 columns.cwiseSqrt().cwiseInverse().asDiagonal();
  return scaled.cwiseAbs().maxCoeff();
}

TEST_P(FreePose, AddsNothingToTheInformation) {
  const Eigen::MatrixXd with = reducedInformation(normalsAt(problem_, estimate_));
  const Eigen::MatrixXd without = reducedInformation(normalsAt(without_, estimate_));
  EXPECT_LT(difference(with, without, without.diagonal(), without.diagonal()), 1e-9);
  const auto shares = frameInformation(problem_, estimate_);
  const Eigen::MatrixXd none = 0 * without;
  EXPECT_LT(difference(shares[kBareFrame], none, without.diagonal(), without.diagonal()), 1e-9);
  EXPECT_GT(difference(shares[kBareFrame + 1], none, without.diagonal(), without.diagonal()), 1e-3);
}

TEST_P(FreePose, AddsNothingToTheSystemOfCamerasAndBoard) {
  const JointSystem with = jointSystem(problem_, estimate_, BoardDetail::kHigher);
  const JointSystem without = jointSystem(without_, estimate_, BoardDetail::kHigher);
  const Eigen::VectorXd g = without.S_gg.diagonal(), h = without.S_hh.diagonal();
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  EXPECT_LT(difference(with.S_gg, without.S_gg, g, g), 1e-9);
  EXPECT_LT(difference(with.S_gh, without.S_gh, g, h), 1e-9);
  EXPECT_LT(difference(with.S_hh, without.S_hh, h, h), 1e-9);
  EXPECT_LT(difference(with.s_g, without.s_g, g, one), 1e-7);
  EXPECT_LT(difference(with.scores.col(kBareFrame), 0 * h, h, one), 1e-7);
}

TEST_P(FreePose, AddsNothingToTheRobustCovariance) {
  const auto covariance = [&](const CameraProblem& problem) {
    return robustCovariance(problem, {estimate_, normalsAt(problem, estimate_), true, 0}, {});
  };
  const auto with = covariance(problem_), without = covariance(without_);
  ASSERT_TRUE(with && without);
  const Eigen::VectorXd variance = without->matrix.diagonal();
  EXPECT_LT(difference(with->matrix, without->matrix, variance, variance), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(OneOrTwoCorners, FreePose,
                         ::testing::Values(std::array<std::size_t, 2>{1, 0},
                                           std::array<std::size_t, 2>{2, 0},
                                           std::array<std::size_t, 2>{0, 2}));

/// One corner that both cameras see: four residuals of a point with three coordinates.
class OneCornerInBoth : public FreePose {};

TEST_P(OneCornerInBoth, IsOneConstraintOnTheCamerasWhateverTheRestOfThePose) {
  const Eigen::MatrixXd all = reducedInformation(normalsAt(problem_, estimate_));
  const Eigen::VectorXd scale = all.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd share = frameInformation(problem_, estimate_)[kBareFrame];
  const Eigen::VectorXd values =
      symmetricEigen(scale.asDiagonal() * share * scale.asDiagonal()).values;
  EXPECT_GT(values.tail<1>()[0], 1e-6);
  EXPECT_LT(values.head(values.size() - 1).cwiseAbs().maxCoeff(), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(OneCorner, OneCornerInBoth,
                         ::testing::Values(std::array<std::size_t, 2>{1, 1}));

}  // namespace
}  // namespace plumbline
