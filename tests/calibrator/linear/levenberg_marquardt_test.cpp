// SPDX-License-Identifier: BSD-3-Clause
// The loop on problems of two unknowns whose minima are known by hand.
#include "calibrator/linear/levenberg_marquardt.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <functional>

#include <gtest/gtest.h>

namespace plumbline {
namespace {

/// Residuals and their Jacobian at a point.
struct Terms {
  Eigen::Vector2d r;
  Eigen::Matrix2d J;
};

struct Steps {
  std::function<Terms(const Eigen::Vector2d&)> terms;
  Eigen::Vector2d x;
  std::function<Trial(const Eigen::Vector2d&, double)> judge =
      [](const Eigen::Vector2d&, double cost) { return Trial{.cost = cost}; };
  Eigen::Vector2d step = Eigen::Vector2d::Zero();
  int refused = 0;

  double costAt(const Eigen::Vector2d& at) const { return 0.5 * terms(at).r.squaredNorm(); }
  double cost() const { return costAt(x); }
  std::optional<double> solve(double damping) {
    const Terms t = terms(x);
    Eigen::Matrix2d H = t.J.transpose() * t.J;
    H.diagonal() *= 1 + damping;
    const Eigen::LLT<Eigen::Matrix2d> llt(H);
    if (llt.info() != Eigen::Success) return std::nullopt;
    const Eigen::Vector2d b = t.J.transpose() * t.r;
    step = -llt.solve(b);
    return -step.dot(b);
  }
  Trial attempt() const { return judge(x + step, costAt(x + step)); }
  void accept() { x += step; }
  bool refuse() {
    ++refused;
    return false;
  }
};

Terms rosenbrock(const Eigen::Vector2d& x) {
  Terms t;
  t.r << 10 * (x(1) - x(0) * x(0)), 1 - x(0);
  t.J << -20 * x(0), 10, -1, 0;
  return t;
}

Terms linear(const Eigen::Vector2d& x) {
  Terms t;
  t.J << 2, 1, 0, 3;
  t.r = t.J * (x - Eigen::Vector2d(4, -1));
  return t;
}

TEST(LevenbergMarquardt, FindsTheMinimumOfACurvedValley) {
  Steps steps{rosenbrock, {-1.2, 1}};
  const MinimiserSummary summary = minimise(steps, {});
  EXPECT_EQ(summary.end, MinimiserEnd::kConverged);
  EXPECT_LT((steps.x - Eigen::Vector2d(1, 1)).norm(), 1e-8);
  EXPECT_LT(summary.iterations, 40);
}

TEST(LevenbergMarquardt, SolvesALinearProblemInTwoSteps) {
  Steps steps{linear, {100, 100}};
  const MinimiserSummary summary = minimise(steps, {.tolerance = 1e-2});
  EXPECT_TRUE(summary.converged());
  EXPECT_LE(summary.iterations, 2);
  EXPECT_LT(summary.last_step, 1e-2);
  EXPECT_LT((steps.x - Eigen::Vector2d(4, -1)).norm(), 1e-6);
}

TEST(LevenbergMarquardt, TakesNoStepThatRaisesTheCost) {
  Steps steps{rosenbrock, {-1.2, 1}};
  double least = steps.cost();
  steps.judge = [&](const Eigen::Vector2d&, double cost) {
    EXPECT_LE(steps.cost(), least * (1 + 1e-12));
    least = steps.cost();
    return Trial{.cost = cost};
  };
  EXPECT_TRUE(minimise(steps, {}).converged());
}

// Much damping makes every step short.
TEST(LevenbergMarquardt, AStepThatDampingMadeShortSaysNothingOfTheMinimum) {
  Steps steps{linear, {100, 100}};
  steps.judge = [&](const Eigen::Vector2d&, double) { return Trial{}; };  // refused
  const MinimiserSummary summary = minimise(steps, {});
  EXPECT_EQ(summary.end, MinimiserEnd::kNoStep);
  EXPECT_GT(summary.last_step, 100);
}

TEST(LevenbergMarquardt, NaNIsRefused) {
  Steps steps{linear, {1, 1}};
  steps.judge = [](const Eigen::Vector2d&, double) {
    return Trial{.cost = std::numeric_limits<double>::quiet_NaN()};
  };
  const MinimiserSummary summary = minimise(steps, {});
  EXPECT_EQ(summary.end, MinimiserEnd::kNoStep);
  EXPECT_EQ(steps.x, Eigen::Vector2d(1, 1));
  EXPECT_EQ(steps.refused, summary.iterations);
}

TEST(LevenbergMarquardt, LeavingTheDomainEndsIt) {
  Steps steps{linear, {1, 1}};
  steps.judge = [](const Eigen::Vector2d&, double) { return Trial{.left_domain = true}; };
  EXPECT_EQ(minimise(steps, {}).end, MinimiserEnd::kLeftDomain);
}

TEST(LevenbergMarquardt, AStepThatChangesTheCostIsNotTheLast) {
  Steps steps{linear, {4, -1}};
  steps.judge = [](const Eigen::Vector2d&, double cost) {
    return Trial{.cost = cost, .renewed = true};
  };
  const MinimiserSummary summary = minimise(steps, {.max_iterations = 7});
  EXPECT_EQ(summary.end, MinimiserEnd::kOutOfIterations);
  EXPECT_EQ(summary.iterations, 7);
}

}  // namespace
}  // namespace plumbline
