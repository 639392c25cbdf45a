// SPDX-License-Identifier: BSD-3-Clause
// The hand-eye problem against Ceres with numeric derivatives: the same minimum from another start,
// and the same covariance.
#include <cmath>
#include <vector>

#include <ceres/covariance.h>
#include <ceres/numeric_diff_cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <gtest/gtest.h>

#include "calibrator/batch/hand_eye.h"
#include "calibrator/simulate/random_stream.h"
#include "calibrator/simulate/trajectory.h"

namespace plumbline {
namespace {

constexpr double kSigmaM = 0.002, kSigmaRad = 0.004;
const Transform kBodyOfMarkers{expSO3({1.9, -0.4, 0.8}), {0.11, -0.07, 0.05}};
const Transform kRoom{expSO3({0, 0.1, -2.2}), {4, -2, 1}};

Vector6d displaced(RandomStream& random) {
  Vector6d d;
  for (int k = 0; k < 6; ++k) d[k] = (k < 3 ? kSigmaM : kSigmaRad) * random.normal();
  return d;
}

std::vector<HandEyePair> noisyPairs() {
  const AnalyticTrajectory motion(AprilGrid{}, simulatedRig("euroc"), TrajectoryOptions());
  RandomStream random(5, RandomPurpose::kTrajectory, {78});
  std::vector<HandEyePair> pairs;
  for (int i = 0; i < 100; ++i) {
    const MotionState body = attached(motion.at(0.3 * i), kBodyOfMarkers);
    HandEyePair& pair = pairs.emplace_back();
    pair.T_WS = motion.at(0.3 * i).T_FB;
    pair.T_VM = boxplus(kRoom * body.T_FB, displaced(random));
    pair.v_V = kRoom.R * body.v_F;
    pair.omega_V = pair.T_VM.R * body.omega_B;
  }
  return pairs;
}

/// The weighted residual after steps (T_SM (6), T_VW (6), offset) from a state.
struct WeightedResidual {
  HandEyePair pair;
  HandEyeState start;

  bool operator()(const double* x, double* out) const {
    HandEyeState state = start;
    state.T_SM = boxplus(start.T_SM, Eigen::Map<const Vector6d>(x));
    state.T_VW = boxplus(start.T_VW, Eigen::Map<const Vector6d>(x + 6));
    state.offset_s += x[12];
    const Vector6d r = handEyeResidual(pair, state).r;
    for (int k = 0; k < 6; ++k) out[k] = r[k] / (k < 3 ? kSigmaM : kSigmaRad);
    return true;
  }
};

TEST(HandEye, IsTheMinimumThatCeresFinds) {
  const std::vector<HandEyePair> pairs = noisyPairs();
  HandEyeOptions options;
  options.with_offset = true;
  options.sigma_m = kSigmaM;
  options.sigma_rad = kSigmaRad;
  const auto found = estimateHandEye(pairs, options);
  ASSERT_TRUE(found.ok());

  HandEyeState start;
  start.T_SM = boxplus(kBodyOfMarkers, Vector6d(Vector6d::Constant(0.02)));
  start.T_VW = kRoom;
  double x[13] = {};
  ceres::Problem problem;
  for (const HandEyePair& pair : pairs) {
    problem.AddResidualBlock(
        new ceres::NumericDiffCostFunction<WeightedResidual, ceres::CENTRAL, 6, 13>(
            new WeightedResidual{pair, start}),
        nullptr, x);
  }
  ceres::Solver::Options solver;
  solver.logging_type = ceres::SILENT;
  solver.function_tolerance = solver.parameter_tolerance = 1e-14;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  ASSERT_TRUE(summary.IsSolutionUsable());

  Eigen::VectorXd apart(13);
  apart << boxminus(found->state.T_SM, boxplus(start.T_SM, Eigen::Map<const Vector6d>(x))),
      boxminus(found->state.T_VW, boxplus(start.T_VW, Eigen::Map<const Vector6d>(x + 6))),
      found->state.offset_s - x[12];
  // The covariance is scaled by what the residuals are of the noise stated.
  const double chi2 = 2 * summary.final_cost / (6.0 * static_cast<double>(pairs.size()) - 13);
  ceres::Covariance covariance{ceres::Covariance::Options()};
  ASSERT_TRUE(covariance.Compute(std::vector<const double*>{x}, &problem));
  Eigen::Matrix<double, 13, 13, Eigen::RowMajor> expected;
  covariance.GetCovarianceBlock(x, x, expected.data());
  for (int k = 0; k < 13; ++k) {
    const double std = std::sqrt(found->covariance(k, k));
    EXPECT_LT(std::abs(apart[k]), 1e-4 * std) << k;
    EXPECT_NEAR(std / std::sqrt(chi2 * expected(k, k)), 1, 0.02) << k;
  }
}

}  // namespace
}  // namespace plumbline
