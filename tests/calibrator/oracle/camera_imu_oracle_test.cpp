// SPDX-License-Identifier: BSD-3-Clause
#include "tests/calibrator/oracle/camera_imu_oracle.h"

#include <Eigen/Cholesky>
#include <cmath>

#include <ceres/gradient_checker.h>
#include <ceres/sphere_manifold.h>
#include <gtest/gtest.h>

#include "calibrator/batch/camera_imu/problem.h"
#include "calibrator/simulate/simulate_session.h"
#include "tests/calibrator/oracle/imu_cost.h"

namespace plumbline::oracle {
namespace {

// A short recording as a batch problem, and its truth.
struct Recording {
  CameraImuProblem problem;
  CameraImuEstimate truth;
};

Recording shortRecording(std::uint64_t seed) {
  SimulationOptions options;
  options.seed = seed;
  options.duration_s = 5;
  options.camera_rate_hz = 5;
  options.target.rows = options.target.cols = 3;
  options.corner_sigma_px = 0.5;
  const SimulatedSession simulated = simulateSession(simulatedRig("euroc"), options);
  Recording recording;
  CameraImuProblem& problem = recording.problem;
  for (const CameraStream& camera : simulated.session.cameras) {
    problem.corners.emplace_back(simulated.session.target, camera.views);
  }
  problem.frames = pairFrames(simulated.session.cameras);
  problem.links.assign(problem.frames.size() - 1, FrameLink::kInertial);
  problem.weights.assign(problem.frames.size(), 1);
  problem.samples = simulated.session.imu->samples;
  problem.noise = simulated.session.imu->noise;
  problem.pixel_sigma = 0.5;
  problem.gravity_m_s2 = simulated.truth.imu->gravity_m_s2;
  for (const Frame& frame : problem.frames) {
    recording.truth.states.push_back(simulated.stateAt(frame.t));
  }
  recording.truth.T_SC0 = simulated.truth.imu->T_SC0;
  recording.truth.gravity_direction = simulated.gravity_F.normalized();
  recording.truth.time_offsets = simulated.truth.imu->time_offsets;
  recording.truth.cameras = simulated.truth.cameras;
  return recording;
}

CameraImuEstimate disturbed(CameraImuEstimate estimate) {
  const Vector15d d = Vector15d::Constant(0.005);
  for (ImuState& state : estimate.states) state = boxplus(state, d);
  estimate.T_SC0 = boxplus(estimate.T_SC0, Vector6d::Constant(0.02));
  estimate.time_offsets[0].s += 1e-3;
  return estimate;
}

void expectSameSolution(const CameraImuProblem& problem, const CameraImuEstimate& start) {
  const ImuWeights weights = imuWeights(problem, start).value();
  const CameraImuSolution oracle = solveWithCeres(problem, start, weights);
  const auto structured = solveCameraImu(problem, start, weights, {200, 1e-9});
  const Eigen::VectorXd sigma = oracle.covariance.diagonal().cwiseSqrt();
  const Eigen::VectorXd d = difference(structured.estimate, oracle.estimate, problem.free_cameras);
  EXPECT_NEAR(structured.normals.cost, oracle.cost, 1e-12 * oracle.cost);
  EXPECT_LT(d.cwiseQuotient(sigma).cwiseAbs().maxCoeff(), 1e-6) << d.cwiseQuotient(sigma);
}

TEST(CameraImuOracle, AgreesWithTheStructuredSolverForFixedCameras) {
  Recording recording = shortRecording(1);
  for (double cauchy_px : {0.0, 1.0}) {
    recording.problem.gram.cauchy_px = cauchy_px;
    expectSameSolution(recording.problem, disturbed(recording.truth));
  }
}

TEST(CameraImuOracle, AgreesWithTheStructuredSolverForFreeCameras) {
  Recording recording = shortRecording(2);
  recording.problem.free_cameras = true;
  expectSameSolution(recording.problem, disturbed(recording.truth));
}

TEST(CameraImuOracle, AgreesWithTheStructuredSolverForAllLinksAndWeights) {
  Recording recording = shortRecording(3);
  recording.problem.links[7] = FrameLink::kBiasWalk;
  recording.problem.links[15] = FrameLink::kBroken;
  for (std::size_t i = 16; i < recording.problem.weights.size(); ++i) {
    recording.problem.weights[i] = 2;
  }
  recording.problem.corners[1].setWeight(recording.problem.frames[3].view[1], 2, 0);
  expectSameSolution(recording.problem, disturbed(recording.truth));
}

TEST(CameraImuOracle, ErrorsAgreeWithTheCovariance) {
  const Recording recording = shortRecording(4);
  const ImuWeights weights = imuWeights(recording.problem, recording.truth).value();
  const CameraImuSolution solution =
      solveWithCeres(recording.problem, disturbed(recording.truth), weights);
  EXPECT_TRUE(solution.converged);
  const Eigen::VectorXd error = difference(solution.estimate, recording.truth, false);
  const double chi2 = error.dot(solution.covariance.ldlt().solve(error));
  EXPECT_GT(chi2, 0.3);   // chi-square, 7 degrees of freedom: 0.01 %
  EXPECT_LT(chi2, 29.9);  // and 99.99 % quantiles
}

// Jacobians of the motion's cost function in the tangent spaces, against Ceres' own differences.
TEST(CameraImuOracle, MotionCostHasTheJacobiansOfItsResidual) {
  const Recording recording = shortRecording(5);
  const CameraImuProblem& problem = recording.problem;
  const CameraImuEstimate estimate = disturbed(recording.truth);
  const ImuWeights weights = imuWeights(problem, estimate).value();
  const MotionCost cost({problem.samples, problem.frames[0].t, problem.frames[1].t,
                         problem.gravity_m_s2, weights[0]});
  const auto pose = makePoseManifold();
  const ceres::EuclideanManifold<1> offset_space;
  const ceres::EuclideanManifold<3> velocity_space;
  const ceres::EuclideanManifold<6> bias_space;
  const ceres::SphereManifold<3> sphere;
  const std::vector<const ceres::Manifold*> manifolds = {pose.get(),   &velocity_space, &bias_space,
                                                         pose.get(),   &velocity_space, &sphere,
                                                         &offset_space};
  const ImuState& i = estimate.states[0];
  const ImuState& j = estimate.states[1];
  const PoseBlock T_i = poseBlockFrom(i.T_FS);
  const PoseBlock T_j = poseBlockFrom(j.T_FS);
  Vector6d biases;
  biases << i.gyro_bias, i.accel_bias;
  const double* blocks[] = {T_i.data(),
                            i.v_F.data(),
                            biases.data(),
                            T_j.data(),
                            j.v_F.data(),
                            estimate.gravity_direction.data(),
                            &estimate.time_offsets[0].s};
  // Interpolated samples make the residual kink in the offset at every sample: the steps stay
  // small.
  ceres::NumericDiffOptions steps;
  steps.ridders_relative_initial_step_size = 1e-5;
  ceres::GradientChecker checker(&cost, &manifolds, steps);
  ceres::GradientChecker::ProbeResults results;
  EXPECT_TRUE(checker.Probe(blocks, 1e-5, &results)) << results.error_log;
}

}  // namespace
}  // namespace plumbline::oracle
