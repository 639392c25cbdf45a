// SPDX-License-Identifier: BSD-3-Clause
#include "tests/calibrator/oracle/camera_imu_oracle.h"

#include <array>

#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <ceres/sphere_manifold.h>

#include "tests/calibrator/oracle/imu_cost.h"
#include "tests/calibrator/oracle/tangent_covariance.h"

namespace plumbline::oracle {
namespace {

struct StateBlocks {
  PoseBlock T_FS;
  std::array<double, 3> velocity;
  std::array<double, 6> biases;
};

// The parameter blocks behind an estimate.
struct Blocks {
  std::vector<StateBlocks> states;
  PoseBlock T_SC0;
  Eigen::Vector3d gravity;
  double offset;
  std::vector<std::vector<double>> intrinsics;
  std::vector<PoseBlock> T_C0Ci;

  explicit Blocks(const CameraImuEstimate& estimate)
      : T_SC0(poseBlockFrom(estimate.T_SC0)),
        gravity(estimate.gravity_direction),
        offset(estimate.timeOffset()) {
    for (const ImuState& state : estimate.states) {
      StateBlocks blocks{poseBlockFrom(state.T_FS), {}, {}};
      Eigen::Map<Eigen::Vector3d>(blocks.velocity.data()) = state.v_F;
      Eigen::Map<Vector6d>(blocks.biases.data()) << state.gyro_bias, state.accel_bias;
      states.push_back(blocks);
    }
    for (const CameraCalibration& camera : estimate.cameras) {
      const Eigen::VectorXd k = camera.intrinsics.stacked();
      intrinsics.emplace_back(k.data(), k.data() + k.size());
      T_C0Ci.push_back(poseBlockFrom(camera.T_C0Ci));
    }
  }
};

class Builder {
 public:
  Builder(const CameraImuProblem& problem, const CameraImuEstimate& start,
          const ImuWeights& weights, Blocks& blocks, ceres::Problem& ceres_problem)
      : problem_(problem),
        start_(start),
        weights_(weights),
        blocks_(blocks),
        ceres_(ceres_problem) {}

  void build() {
    for (std::size_t i = 0; i < problem_.frames.size(); ++i) {
      for (std::size_t c = 0; c < start_.cameras.size(); ++c) addView(i, c);
      if (i + 1 < problem_.frames.size()) addLink(i);
    }
    setManifolds();
  }

 private:
  ceres::LossFunction* scaled(ceres::LossFunction* loss, double factor) const {
    return new ceres::ScaledLoss(loss, factor, ceres::TAKE_OWNERSHIP);
  }

  void addView(std::size_t i, std::size_t c) {
    const int index = problem_.frames[i].view[c];
    if (index < 0) return;
    const PackedView view = problem_.corners[c].view(index);
    const double factor = problem_.weights[i] / (problem_.pixel_sigma * problem_.pixel_sigma);
    for (int k = 0; k < view.count; ++k) {
      if (view.w[k] == 0) continue;
      const CornerMeasurement corner{{view.x[k], view.y[k]}, {view.u[k], view.v[k]}};
      ceres::LossFunction* loss = nullptr;
      if (problem_.gram.cauchy_px > 0) loss = new ceres::CauchyLoss(problem_.gram.cauchy_px);
      ceres_.AddResidualBlock(
          makeImuReprojectionCost(start_.cameras[c].intrinsics, corner).release(),
          scaled(loss, factor), blocks_.intrinsics[c].data(), blocks_.T_C0Ci[c].data(),
          blocks_.T_SC0.data(), blocks_.states[i].T_FS.data());
    }
  }

  void addLink(std::size_t i) {
    if (problem_.links[i] == FrameLink::kBroken) return;
    StateBlocks& from = blocks_.states[i];
    StateBlocks& to = blocks_.states[i + 1];
    ceres_.AddResidualBlock(new BiasWalkCost(weights_[i]), scaled(nullptr, problem_.weights[i]),
                            from.biases.data(), to.biases.data());
    if (problem_.links[i] != FrameLink::kInertial) return;
    const ImuInterval interval{problem_.samples, problem_.frames[i].t, problem_.frames[i + 1].t,
                               problem_.gravity_m_s2, weights_[i]};
    ceres_.AddResidualBlock(new MotionCost(interval), scaled(nullptr, problem_.weights[i]),
                            from.T_FS.data(), from.velocity.data(), from.biases.data(),
                            to.T_FS.data(), to.velocity.data(), blocks_.gravity.data(),
                            &blocks_.offset);
  }

  void setManifolds() {
    for (StateBlocks& state : blocks_.states) {
      ceres_.SetManifold(state.T_FS.data(), makePoseManifold().release());
    }
    ceres_.SetManifold(blocks_.T_SC0.data(), makePoseManifold().release());
    ceres_.SetManifold(blocks_.gravity.data(), new ceres::SphereManifold<3>());
    for (std::size_t c = 0; c < blocks_.T_C0Ci.size(); ++c) {
      ceres_.SetManifold(blocks_.T_C0Ci[c].data(), makePoseManifold().release());
      if (!problem_.free_cameras) ceres_.SetParameterBlockConstant(blocks_.intrinsics[c].data());
      if (!problem_.free_cameras || c == 0) {
        ceres_.SetParameterBlockConstant(blocks_.T_C0Ci[c].data());
      }
    }
  }

  const CameraImuProblem& problem_;
  const CameraImuEstimate& start_;
  const ImuWeights& weights_;
  Blocks& blocks_;
  ceres::Problem& ceres_;
};

ceres::Solver::Options solverOptions(const CameraImuOptions& options) {
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = 1e-16;  // to rounding: it is an oracle
  solver.gradient_tolerance = 1e-16;
  solver.parameter_tolerance = 1e-14;
  solver.num_threads = options.threads;
  solver.logging_type = ceres::SILENT;
  return solver;
}

Eigen::MatrixXd covarianceOf(ceres::Problem& problem, const Blocks& blocks, bool free_cameras) {
  std::vector<const double*> globals{blocks.T_SC0.data(), &blocks.offset};
  std::vector<double> scale{1, 1, 1, 2, 2, 2, 1};
  for (std::size_t c = 0; free_cameras && c < blocks.intrinsics.size(); ++c) {
    globals.push_back(blocks.intrinsics[c].data());
    scale.insert(scale.end(), blocks.intrinsics[c].size(), 1.0);
    if (c == 0) continue;
    globals.push_back(blocks.T_C0Ci[c].data());
    scale.insert(scale.end(), {1, 1, 1, 2, 2, 2});
  }
  return tangentCovariance(problem, globals, scale);
}

CameraImuEstimate estimateFrom(const CameraImuEstimate& start, const Blocks& blocks) {
  CameraImuEstimate estimate = start;
  for (std::size_t i = 0; i < estimate.states.size(); ++i) {
    const StateBlocks& from = blocks.states[i];
    ImuState& state = estimate.states[i];
    state.T_FS = transformFrom(from.T_FS);
    state.v_F = Eigen::Map<const Eigen::Vector3d>(from.velocity.data());
    state.gyro_bias = Eigen::Map<const Eigen::Vector3d>(from.biases.data());
    state.accel_bias = Eigen::Map<const Eigen::Vector3d>(from.biases.data() + 3);
  }
  estimate.T_SC0 = transformFrom(blocks.T_SC0);
  estimate.gravity_direction = blocks.gravity;
  estimate.time_offsets = {{blocks.offset}};
  for (std::size_t c = 0; c < estimate.cameras.size(); ++c) {
    const auto& k = blocks.intrinsics[c];
    estimate.cameras[c].intrinsics.setStacked(
        Eigen::Map<const Eigen::VectorXd>(k.data(), static_cast<Eigen::Index>(k.size())));
    estimate.cameras[c].T_C0Ci = transformFrom(blocks.T_C0Ci[c]);
  }
  return estimate;
}

}  // namespace

CameraImuSolution solveWithCeres(const CameraImuProblem& problem, const CameraImuEstimate& start,
                                 const ImuWeights& weights, const CameraImuOptions& options) {
  Blocks blocks(start);
  ceres::Problem ceres_problem;
  Builder(problem, start, weights, blocks, ceres_problem).build();
  ceres::Solver::Summary summary;
  ceres::Solve(solverOptions(options), &ceres_problem, &summary);
  CameraImuSolution solution;
  solution.estimate = estimateFrom(start, blocks);
  solution.cost = summary.final_cost;
  solution.converged = summary.termination_type == ceres::CONVERGENCE;
  solution.iterations = static_cast<int>(summary.iterations.size());
  if (options.covariance) {
    solution.covariance = covarianceOf(ceres_problem, blocks, problem.free_cameras);
  }
  return solution;
}

Eigen::VectorXd difference(const CameraImuEstimate& to, const CameraImuEstimate& from,
                           bool free_cameras) {
  std::vector<double> all;
  const auto append = [&](const Eigen::VectorXd& d) {
    all.insert(all.end(), d.data(), d.data() + d.size());
  };
  append(boxminus(to.T_SC0, from.T_SC0));
  all.push_back(to.timeOffset() - from.timeOffset());
  for (std::size_t c = 0; free_cameras && c < to.cameras.size(); ++c) {
    append(to.cameras[c].intrinsics.stacked() - from.cameras[c].intrinsics.stacked());
    if (c > 0) append(boxminus(to.cameras[c].T_C0Ci, from.cameras[c].T_C0Ci));
  }
  return Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

}  // namespace plumbline::oracle
