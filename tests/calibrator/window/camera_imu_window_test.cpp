// SPDX-License-Identifier: BSD-3-Clause
// The camera-IMU window and its prior, against the batch over the same frames. Whether its
// covariance is honest is for camera_imu_window_statistics_test.
#include "calibrator/window/camera_imu_window.h"

#include <Eigen/Cholesky>
#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/information/covariance.h"
#include "tests/calibrator/window/imu_window_recording.h"

namespace plumbline {
namespace {

SimulationOptions shortRecording(double duration_s = 3) {
  SimulationOptions options;
  options.duration_s = duration_s;
  options.corner_sigma_px = 0.2;
  return options;
}

const test::WindowRecording& recording() {
  static const test::WindowRecording r = test::recordingOf(shortRecording(), 0.2);
  return r;
}

/// A few frames at their least-squares solution.
struct Solved {
  CameraImuProblem problem;
  CameraImuEstimate estimate;
  ImuWeights weights;
};
Solved solvedFrames(int count) {
  Solved s{test::firstFrames(recording(), count), {}, {}};
  s.estimate = test::solvedWithOffsetHeld(s.problem, test::firstStates(recording().truth, count));
  s.weights = *imuWeights(s.problem, s.estimate);
  return s;
}

/// Dense normal equations of a chain, all blocks and the border.
Eigen::MatrixXd dense(const BlockArrow& chain) {
  const int n = kChainBlock * chain.blocks();
  const int m = chain.border();
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n + m, n + m);
  for (int i = 0; i < chain.blocks(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    H.block<15, 15>(15 * i, 15 * i) = chain.diagonal[at];
    if (i + 1 < chain.blocks()) H.block<15, 15>(15 * i, 15 * i + 15) = chain.next[at];
    H.block(15 * i, n, 15, m) = chain.to_border[at].leftCols(m);
  }
  H.bottomRightCorner(m, m) = chain.border_block;
  return H.selfadjointView<Eigen::Upper>();
}

TEST(CameraImuPrior, FrontEliminatedIsTheInverseOfTheFullInversesBlock) {
  const Solved s = solvedFrames(40);
  const BlockArrow chain = informationAt(s.problem, s.estimate, s.weights)->chain;
  const auto end = frontEliminated(chain, cameraInformationAt(s.problem, s.estimate).chain, 39);
  ASSERT_TRUE(end);
  const Eigen::MatrixXd H = dense(chain);
  const Eigen::VectorXd scale = H.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * H * scale.asDiagonal();
  const Eigen::MatrixXd inverse = scaled.inverse();
  const int size = 15 + chain.border();
  const auto tail = scale.tail(size);
  const Eigen::MatrixXd product =
      inverse.bottomRightCorner(size, size) * (tail.asDiagonal() * end->H * tail.asDiagonal());
  EXPECT_LT((product - Eigen::MatrixXd::Identity(size, size)).norm(), 1e-6);
}

// At the least-squares solution the gradient by a state that leaves is zero, so that nothing is
// gained by moving it: the prior's cost is that of the terms dropped, to the last digits.
TEST(CameraImuPrior, CostAtItsPointIsThatOfTheTermsDropped) {
  const Solved s = solvedFrames(8);
  const auto prior = marginaliseFront(s.problem, s.estimate, s.weights, std::nullopt, 5);
  ASSERT_TRUE(prior);
  CameraImuProblem dropped = test::firstFrames(recording(), 6);
  for (int& view : dropped.frames.back().view) view = -1;
  const double cost = normalsAt(dropped, test::firstStates(s.estimate, 6), s.weights)->cost;
  CameraImuEstimate after = s.estimate;
  after.states = {s.estimate.states[5]};
  EXPECT_GT(cost, 100);
  EXPECT_NEAR(prior->at(after).c, cost, 1e-8 * cost);
}

// With the prior in place of the frames dropped, cost and gradient at the point are those of all
// frames; and so is the information of what stays.
TEST(CameraImuPrior, StandsForTheFramesDropped) {
  const Solved s = solvedFrames(8);
  const auto prior = marginaliseFront(s.problem, s.estimate, s.weights, std::nullopt, 5);
  ASSERT_TRUE(prior);
  const auto all = informationAt(s.problem, s.estimate, s.weights);
  CameraImuProblem kept = s.problem;
  kept.frames.erase(kept.frames.begin(), kept.frames.begin() + 5);
  kept.links.resize(2);
  kept.weights.resize(3);
  CameraImuEstimate estimate = s.estimate;
  estimate.states.erase(estimate.states.begin(), estimate.states.begin() + 5);
  auto normals = informationAt(kept, estimate, {s.weights[5], s.weights[6]});
  addPrior(*prior, estimate, *normals);
  EXPECT_NEAR(normals->cost, all->cost, 1e-8 * all->cost);
  const auto a = solveChain(all->chain);
  const auto b = solveChain(normals->chain);
  ASSERT_TRUE(a && b);
  const auto& H = a->border_information;
  EXPECT_LT((b->border_information - H).norm(), 1e-7 * H.norm());
  EXPECT_LT((b->step[0] - a->step[5]).norm(), 1e-7);
  EXPECT_LT((b->border_step - a->border_step).norm(), 1e-7);
}

// The gradient is that of the cost along the tangents at an estimate off the prior's point, by
// central differences.
TEST(CameraImuPrior, GradientFollowsTheEstimate) {
  const Solved s = solvedFrames(8);
  const auto prior = marginaliseFront(s.problem, s.estimate, s.weights, std::nullopt, 5);
  CameraImuEstimate off = s.estimate;
  off.states = {boxplus(s.estimate.states[5], Vector15d::Constant(0.02))};
  off.T_SC0 = boxplus(off.T_SC0, Vector6d::Constant(0.03));
  off.gravity_direction = boxplusDirection(off.gravity_direction, {0.02, -0.01});
  CameraImuNormals normals{BlockArrow(1, BorderLayout::kFixed)};
  addPrior(*prior, off, normals);
  EXPECT_NEAR(normals.cost, prior->at(off).c, 1e-9 * normals.cost);
  const auto costAlong = [&](int k, double h) {
    ChainSolution step;
    step.step = {Eigen::Matrix<double, 15, 1>::Zero()};
    step.border_step = Eigen::VectorXd::Zero(BorderLayout::kFixed);
    (k < 15 ? step.step[0](k) : step.border_step(k - 15)) = h;
    return prior->at(moved(off, step, false)).c;
  };
  Eigen::VectorXd gradient(15 + BorderLayout::kFixed);
  gradient << normals.chain.to_border[0].rightCols<1>(), normals.chain.border_gradient;
  const Eigen::VectorXd scale = prior->cost.H.diagonal().cwiseSqrt().cwiseInverse();
  const double size = scale.cwiseProduct(gradient).norm();
  EXPECT_GT(size, 1);
  for (int k = 0; k < gradient.size(); ++k) {
    const double h = 1e-3 * scale(k);
    const double slope = (costAlong(k, h) - costAlong(k, -h)) / (2 * h);
    // Gravity's tangent turns with the direction: exact but for the square of the angle between.
    const bool gravity = k >= 21 && k < 23;
    EXPECT_NEAR(scale(k) * gradient(k), scale(k) * slope, (gravity ? 1e-3 : 1e-6) * size) << k;
  }
}

TEST(CameraImuWindow, WithoutNoiseItStaysAtTheTruth) {
  SimulationOptions exact = shortRecording();
  exact.imu_noise = false;
  exact.imu_rate_hz = 1000;
  exact.corner_sigma_px = 0;
  const test::WindowRecording r = test::recordingOf(exact, 0.2);
  const auto window = test::windowOver(r, 25);
  ASSERT_TRUE(window);
  EXPECT_LT(boxminus(window->estimate().T_SC0, r.truth.T_SC0).norm(), 1e-5);
  EXPECT_LT(window->rmsePx(), 1e-3);
}

TEST(CameraImuWindow, EndsNearTheBatchInItsOwnStandardDeviations) {
  const auto window = test::windowOver(recording(), 25);
  ASSERT_TRUE(window);
  const auto batch = test::solvedWithOffsetHeld(recording().problem, recording().truth);
  const Vector6d d = boxminus(window->estimate().T_SC0, batch.T_SC0);
  const Eigen::MatrixXd information = test::batchInformation(recording().problem, batch);
  EXPECT_LT(std::sqrt(d.dot(information * d)), 0.5);
  // What it knows is what the batch knows.
  const auto known = window->knowledge();
  ASSERT_TRUE(known);
  for (const bool offset : {false, true}) {
    const auto own = calibrationInformation(known->information, offset);
    ASSERT_TRUE(own);
    EXPECT_NEAR(*entropyNats(*own),
                *entropyNats(test::batchInformation(recording().problem, batch, offset)), 0.05);
  }
}

// What corners of another noise than assumed make of the covariance is what they make of the
// batch's: their share went through the prior with the information.
TEST(CameraImuWindow, KnowsTheCornersShareAsTheBatchDoes) {
  const auto window = test::windowOver(recording(), 25);
  ASSERT_TRUE(window);
  const auto known = window->knowledge();
  ASSERT_TRUE(known);
  const SolvedCameraImu batch{recording().problem,
                              test::solvedWithOffsetHeld(recording().problem, recording().truth)};
  for (const double variance : {0.04, 1.0, 25.0}) {
    const auto own = calibrationCovariance(*known, {.corners = variance});
    const auto expected = covarianceUnder(batch, {.corner = std::sqrt(variance)});
    ASSERT_TRUE(own && expected);
    for (int i = 0; i < 7; ++i) {
      EXPECT_NEAR(std::sqrt((*own)(i, i) / (*expected)(i, i)), 1, 0.05) << variance << ' ' << i;
    }
  }
  EXPECT_LT((*calibrationCovariance(*known, {.corners = 0.04}))(5, 5),
            0.95 * (*calibrationCovariance(*known, {}))(5, 5));
}

TEST(CameraImuWindow, HoldsItsSizeAndTheTimeOffset) {
  const auto window = test::windowOver(recording(), 25);
  ASSERT_TRUE(window);
  EXPECT_EQ(window->estimate().states.size(), 3u);
  EXPECT_EQ(window->problem().frames.size(), 3u);
  EXPECT_EQ(window->estimate().timeOffset(), recording().truth.timeOffset());
  EXPECT_LT(window->problem().samples.size(), 500u + 300u);
}

// Frames 30 to 39 are missing and so are the samples between: the next frame waits for the one
// after it, both enter, and knowledge of T_SC0 is neither lost nor invented.
TEST(CameraImuWindow, GoesOnAcrossAGapByTheBiasesWalk) {
  const test::WindowRecording& r = recording();
  auto window = test::windowOver(r, 25);
  const CameraImuProblem first = test::firstFrames(r, 25);
  window = CameraImuWindow::fromBatch(
      first, test::solvedWithOffsetHeld(first, test::firstStates(r.truth, 25)),
      r.simulated.session.target);
  ASSERT_TRUE(window);
  for (int i = 25; i < 30; ++i) ASSERT_EQ(window->add(test::windowFrame(r, i)), WindowEnd::kSolved);
  const double before =
      *entropyNats(*calibrationInformation(window->knowledge()->information, false));
  WindowFrame loose = test::windowFrame(r, 40);
  loose.link = FrameLink::kBiasWalk;
  EXPECT_EQ(window->add(loose), WindowEnd::kWaiting);
  EXPECT_EQ(window->lastStamp(), r.problem.frames[29].t);
  EXPECT_EQ(window->add(test::windowFrame(r, 41)), WindowEnd::kSolved);
  EXPECT_EQ(window->problem().frames[1].t, r.problem.frames[40].t);
  const double after =
      *entropyNats(*calibrationInformation(window->knowledge()->information, false));
  EXPECT_LT(after, before);
  EXPECT_GT(after, before - 0.1);
  for (int i = 42; i < 50; ++i) ASSERT_EQ(window->add(test::windowFrame(r, i)), WindowEnd::kSolved);
  const Vector6d error = boxminus(window->estimate().T_SC0, r.truth.T_SC0);
  const auto information = calibrationInformation(window->knowledge()->information, false);
  EXPECT_LT(error.dot(*information * error), 22.46);  // chi-square, 6 dof, 99.9 %
}

TEST(CameraImuWindow, AFrameThatSamplesDoNotReachLeavesItAsItWas) {
  const test::WindowRecording& r = recording();
  auto window = test::windowOver(r, 25);
  ASSERT_TRUE(window);
  const Transform T_SC0 = window->estimate().T_SC0;
  WindowFrame late = test::windowFrame(r, 10);
  late.t = window->lastStamp() + toNanoseconds(30);
  EXPECT_EQ(window->add(late), WindowEnd::kNotSolved);
  EXPECT_EQ(window->lastStamp(), r.problem.frames.back().t);
  EXPECT_EQ((window->estimate().T_SC0.matrix() - T_SC0.matrix()).norm(), 0);
}

}  // namespace
}  // namespace plumbline
