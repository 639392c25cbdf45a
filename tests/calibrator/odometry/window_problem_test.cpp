// SPDX-License-Identifier: BSD-3-Clause
// The cost of a window and what is left of it when a frame leaves: terms computed by hand, a
// minimum that is known, and elimination held against that of all at once.
#include "calibrator/odometry/window_problem.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "tests/calibrator/odometry/exact_window.h"

namespace plumbline {
namespace {

using test::ExactWindow;

double costOf(const ExactWindow& x, const WindowModel& model = {}) {
  Window window = x.window;
  return WindowProblem(window, x.rig, model).cost();
}

/// Pulls the first frame's position and attitude to where they are.
WindowPrior holding(const OdometryFrame& frame) {
  WindowPrior prior{{frame.serial}, {frame.state}, {}};
  prior.cost = {Eigen::MatrixXd::Zero(kState, kState), Eigen::VectorXd::Zero(kState), 0};
  prior.cost.H.diagonal().head<6>().setConstant(1e8);
  return prior;
}

/// Four frames, points that the first two and three see and points that the later ones see.
ExactWindow exampleOfFour() {
  ExactWindow x(4);
  x.addLandmarks(100, 0, 2);
  x.addLandmarks(200, 1, 3);
  x.window.prior = holding(x.window.frames.front());
  return x;
}

Vector15d smallStep(int k) {
  Vector15d d;
  for (int i = 0; i < kState; ++i) d[i] = 1e-3 * std::sin(1 + 3.7 * i + 11 * k);
  return d;
}

TEST(WindowProblem, CostsNothingWhereEverythingAgrees) {
  EXPECT_LT(costOf(exampleOfFour()), 1e-12);
}

TEST(WindowProblem, ASightingCostsByCauchysLoss) {
  ExactWindow x(1);
  const Eigen::Vector3d p = x.ahead(0, 0, 0, 3);
  Landmark& landmark = x.window.landmarks[1];
  landmark.p_W = p;
  landmark.sightings = {x.sighted(p, 0, 0), x.sighted(p, 0, 1)};
  // Bearings that do not fit: three deviations by the rule of the sighting itself.
  Sighting& seen = landmark.sightings[1].seen;
  seen = x.sighted(p, 0, 1, {2, 2}).seen;
  const auto e = sightingError(seen, x.rig, x.window.frames[0].state.T_FS, p);
  const double s = e->squaredNorm();
  EXPECT_NEAR(std::sqrt(s), std::sqrt(8), 0.05);
  WindowModel model;
  model.cauchy = 0;
  EXPECT_NEAR(costOf(x, model), 0.5 * s, 1e-9);
  model.cauchy = 2;
  EXPECT_NEAR(costOf(x, model), 0.5 * 4 * std::log(1 + s / 4), 1e-9);
  // One ray alone says nothing of the frames.
  landmark.sightings.erase(landmark.sightings.begin());
  EXPECT_EQ(costOf(x, model), 0);
}

TEST(WindowProblem, AStandingRigCostsByItsVelocity) {
  ExactWindow x(1);
  x.window.frames[0].state.v_F << 0.03, 0, 0.04;
  EXPECT_EQ(costOf(x), 0);
  x.window.frames[0].still = true;
  EXPECT_NEAR(costOf(x), 0.5 * 25, 1e-9);  // five deviations of 0.01 m/s
}

TEST(WindowProblem, AStandingRigIsBroughtToAStand) {
  ExactWindow x(1);
  x.window.prior = holding(x.window.frames[0]);
  x.window.prior.cost.H.diagonal().tail<6>().setConstant(1);
  x.window.frames[0].still = true;
  const ImuState before = x.window.frames[0].state;
  WindowProblem problem(x.window, x.rig, {});
  minimise(problem, {});
  const ImuState& after = x.window.frames[0].state;
  EXPECT_LT(after.v_F.norm(), 1e-9);
  EXPECT_EQ(after.T_FS.t, before.T_FS.t);
  EXPECT_EQ(after.gyro_bias, before.gyro_bias);
}

TEST(WindowProblem, ThePriorCostsByTheWayFromItsPoints) {
  ExactWindow x(2);
  WindowPrior& prior = x.window.prior;
  prior = holding(x.window.frames[1]);
  prior.cost.H.setIdentity();
  prior.cost.H(0, 1) = prior.cost.H(1, 0) = 0.5;
  prior.cost.b[1] = 7;
  prior.cost.c = 100;
  prior.points[0].T_FS.t -= Eigen::Vector3d(2, 3, 0);  // so the frame is (2, 3, 0) away
  x.window.frames[0].link.reset();
  EXPECT_NEAR(costOf(x), 100 + 7 * 3 + 0.5 * (4 + 9 + 2 * 0.5 * 6), 1e-9);
}

// From states and points that are off, back to where all terms are zero.
TEST(WindowProblem, ItsMinimumIsTheTruth) {
  const ExactWindow truth = exampleOfFour();
  Window window = truth.window;
  for (std::size_t k = 0; k < window.frames.size(); ++k) {
    window.frames[k].state = boxplus(window.frames[k].state, 10 * smallStep(static_cast<int>(k)));
  }
  for (auto& [id, landmark] : window.landmarks) {
    *landmark.p_W += 0.05 * Eigen::Vector3d(std::sin(id), std::cos(id), std::sin(2 * id));
  }
  WindowProblem problem(window, truth.rig, {});
  EXPECT_GT(problem.cost(), 100);
  MinimiserOptions options;
  options.max_iterations = 30;
  options.tolerance = 1e-6;
  minimise(problem, options);
  EXPECT_LT(problem.cost(), 1e-6);
  for (std::size_t k = 0; k < window.frames.size(); ++k) {
    const Vector15d off = boxminus(window.frames[k].state, truth.window.frames[k].state);
    EXPECT_LT(off.head<9>().norm(), 1e-5) << k;
    EXPECT_LT(off.tail<6>().norm(), 1e-3) << k;
  }
  for (const auto& [id, landmark] : window.landmarks) {
    EXPECT_LT((*landmark.p_W - *truth.window.landmarks.at(id).p_W).norm(), 1e-4) << id;
  }
}

TEST(WindowProblem, ATrialThatIsNotAcceptedLeavesNoTrace) {
  ExactWindow x = exampleOfFour();
  x.window.frames[2].state = boxplus(x.window.frames[2].state, smallStep(1));
  const Window before = x.window;
  WindowProblem problem(x.window, x.rig, {});
  ASSERT_TRUE(problem.solve(1e-3));
  EXPECT_LT(problem.attempt().cost, problem.cost());
  for (std::size_t k = 0; k < before.frames.size(); ++k) {
    EXPECT_TRUE(boxminus(x.window.frames[k].state, before.frames[k].state).isZero()) << k;
  }
  for (const auto& [id, landmark] : before.landmarks) {
    EXPECT_EQ(*x.window.landmarks.at(id).p_W, *landmark.p_W) << id;
  }
}

/// Largest difference of two costs, in units in which the first has a unit diagonal: metres beside
/// biases.
double difference(const QuadraticCost& a, const QuadraticCost& b) {
  const Eigen::VectorXd unit = a.H.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd H = unit.asDiagonal() * (a.H - b.H) * unit.asDiagonal();
  const double gradient = unit.cwiseProduct(a.b - b.b).norm() / unit.cwiseProduct(a.b).norm();
  return std::max({H.norm(), gradient, std::abs(a.c - b.c) / std::abs(a.c)});
}

/// Takes the oldest frame out, with all the points that it sees, and compares the cost of the
/// others with the Schur complement of all.
void expectNothingLost(Window& window, const RigModel& rig,
                       const std::set<std::int64_t>& landmarks) {
  const WindowModel model;
  const std::int64_t serial = window.frames.front().serial;
  const QuadraticCost all = WindowProblem(window, rig, model).reduced();
  std::vector<int> keep;
  for (int row = 0; row < all.H.rows(); ++row) {
    if (row >= kState) keep.push_back(row);
  }
  const auto expected = marginalised(all, keep);
  ASSERT_TRUE(expected);
  ASSERT_TRUE(marginaliseOldest(window, landmarks, rig, model));
  EXPECT_EQ(window.indexOf(serial), -1);
  const QuadraticCost left = WindowProblem(window, rig, model).reduced();
  ASSERT_EQ(left.H.rows(), expected->H.rows());
  EXPECT_LT(difference(*expected, left), 1e-6) << serial;
}

/// The example with states that are off, so that gradients are not zero.
ExactWindow unsettledFour() {
  ExactWindow x = exampleOfFour();
  for (std::size_t k = 0; k < 4; ++k) {
    x.window.frames[k].state = boxplus(x.window.frames[k].state, smallStep(static_cast<int>(k)));
    x.window.frames[k].still = k < 3;
  }
  return x;
}

std::set<std::int64_t> sixteenFrom(std::int64_t first) {
  std::set<std::int64_t> ids;
  for (int i = 0; i < 16; ++i) ids.insert(first + i);
  return ids;
}

TEST(Marginalise, TheOldestFrameLeavesAllThatItSaid) {
  ExactWindow x = unsettledFour();
  expectNothingLost(x.window, x.rig, sixteenFrom(100));
  EXPECT_EQ(x.window.landmarks.size(), 16U);
  EXPECT_EQ(x.window.prior.frames, (std::vector<std::int64_t>{11, 12}));
}

// The prior is about first estimates, which the states have left since.
TEST(Marginalise, ThePriorOfBeforeIsCarriedOnFromWhereItWasTaken) {
  ExactWindow x = unsettledFour();
  ASSERT_TRUE(marginaliseOldest(x.window, sixteenFrom(100), x.rig, {}));
  const ImuState first = x.window.frames[1].state;
  // As far as a window may move: what is second order stays below the comparison's bound.
  for (OdometryFrame& frame : x.window.frames) {
    Vector15d d = Vector15d::Zero();
    d.head<3>() << 0.02, -0.03, 0.01;
    d.segment<3>(6) << -0.05, 0.02, 0.04;
    frame.state = boxplus(frame.state, d);
  }
  expectNothingLost(x.window, x.rig, sixteenFrom(200));
  EXPECT_EQ(x.window.prior.frames, (std::vector<std::int64_t>{12, 13}));
  ASSERT_TRUE(x.window.frames[0].first_estimate);
  EXPECT_TRUE(boxminus(*x.window.frames[0].first_estimate, first).isZero());
  EXPECT_TRUE(boxminus(x.window.prior.points[0], first).isZero());
}

TEST(Marginalise, PointsThatStayLoseTheFramesSighting) {
  ExactWindow x = exampleOfFour();
  ASSERT_TRUE(marginaliseOldest(x.window, {}, x.rig, {}));
  ASSERT_EQ(x.window.landmarks.size(), 32U);
  for (const LandmarkSighting& s : x.window.landmarks.at(100).sightings) EXPECT_GT(s.frame, 10);
  EXPECT_EQ(x.window.landmarks.at(100).sightings.size(), 4U);
  EXPECT_EQ(x.window.landmarks.at(200).sightings.size(), 6U);
}

}  // namespace
}  // namespace plumbline
