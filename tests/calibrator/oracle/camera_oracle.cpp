// SPDX-License-Identifier: BSD-3-Clause
#include "tests/calibrator/oracle/camera_oracle.h"

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/ordered_groups.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include "tests/calibrator/oracle/reprojection_cost.h"
#include "tests/calibrator/oracle/tangent_covariance.h"

namespace plumbline::oracle {
namespace {

// The parameter blocks behind a CameraState.
struct CameraBlocks {
  std::vector<std::vector<double>> intrinsics;
  std::vector<PoseBlock> T_C0Ci;
  std::vector<PoseBlock> T_FC0;

  explicit CameraBlocks(const CameraState& state) {
    for (const CameraCalibration& camera : state.cameras) {
      const Eigen::VectorXd k = camera.intrinsics.stacked();
      intrinsics.emplace_back(k.data(), k.data() + k.size());
      T_C0Ci.push_back(poseBlockFrom(camera.T_C0Ci));
    }
    for (const Transform& T : state.T_FC0) T_FC0.push_back(poseBlockFrom(T));
  }

  // CameraBlocks of the calibration in the order of the covariance.
  std::vector<const double*> globals() const {
    std::vector<const double*> all;
    for (const auto& k : intrinsics) all.push_back(k.data());
    for (std::size_t i = 1; i < T_C0Ci.size(); ++i) all.push_back(T_C0Ci[i].data());
    return all;
  }
};

ceres::LossFunction* lossOf(const CameraOptions& options) {
  ceres::LossFunction* loss = nullptr;
  if (options.cauchy_px > 0) loss = new ceres::CauchyLoss(options.cauchy_px);
  return new ceres::ScaledLoss(loss, 1 / (options.pixel_sigma * options.pixel_sigma),
                               ceres::TAKE_OWNERSHIP);
}

void addView(const Session& session, const CameraState& start, int camera, const ImageView& view,
             PoseBlock& T_FC0, const CameraOptions& options, CameraBlocks& blocks,
             ceres::Problem& problem) {
  for (const Corner& corner : view.corners) {
    const CornerMeasurement measured{session.target.corner(corner.id), corner.uv};
    problem.AddResidualBlock(
        makeReprojectionCost(start.cameras[camera].intrinsics, measured).release(), lossOf(options),
        blocks.intrinsics[camera].data(), blocks.T_C0Ci[camera].data(), T_FC0.data());
  }
}

void build(const Session& session, const std::vector<Frame>& frames, const CameraState& start,
           const CameraOptions& options, CameraBlocks& blocks, ceres::Problem& problem) {
  for (std::size_t f = 0; f < frames.size(); ++f) {
    for (std::size_t c = 0; c < session.cameras.size(); ++c) {
      const int view = frames[f].view[c];
      if (view < 0) continue;
      addView(session, start, static_cast<int>(c), session.cameras[c].views[view], blocks.T_FC0[f],
              options, blocks, problem);
    }
    problem.SetManifold(blocks.T_FC0[f].data(), makePoseManifold().release());
  }
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    problem.SetManifold(blocks.T_C0Ci[c].data(), makePoseManifold().release());
  }
  problem.SetParameterBlockConstant(blocks.T_C0Ci[0].data());
}

ceres::Solver::Options solverOptions(const CameraOptions& options, CameraBlocks& blocks) {
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_SCHUR;
  solver.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (PoseBlock& pose : blocks.T_FC0) {
    solver.linear_solver_ordering->AddElementToGroup(pose.data(), 0);
  }
  for (const double* block : blocks.globals()) {
    solver.linear_solver_ordering->AddElementToGroup(const_cast<double*>(block), 1);
  }
  solver.linear_solver_ordering->AddElementToGroup(blocks.T_C0Ci[0].data(), 1);
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = 1e-16;  // to rounding: it is an oracle
  solver.gradient_tolerance = 1e-16;
  solver.parameter_tolerance = 1e-14;
  solver.num_threads = options.threads;
  solver.logging_type = ceres::SILENT;
  return solver;
}

Eigen::MatrixXd covarianceOf(ceres::Problem& problem, const CameraBlocks& blocks) {
  std::vector<double> scale;
  for (const auto& k : blocks.intrinsics) scale.insert(scale.end(), k.size(), 1.0);
  for (std::size_t i = 1; i < blocks.T_C0Ci.size(); ++i) {
    scale.insert(scale.end(), {1, 1, 1, 2, 2, 2});
  }
  return tangentCovariance(problem, blocks.globals(), scale);
}

CameraState stateFrom(const CameraState& start, const CameraBlocks& blocks) {
  CameraState state = start;
  for (std::size_t c = 0; c < state.cameras.size(); ++c) {
    const auto& k = blocks.intrinsics[c];
    state.cameras[c].intrinsics.setStacked(
        Eigen::Map<const Eigen::VectorXd>(k.data(), static_cast<int>(k.size())));
    state.cameras[c].T_C0Ci = transformFrom(blocks.T_C0Ci[c]);
  }
  for (std::size_t f = 0; f < state.T_FC0.size(); ++f) {
    state.T_FC0[f] = transformFrom(blocks.T_FC0[f]);
  }
  return state;
}

}  // namespace

CameraSolution solveCameras(const Session& session, const std::vector<Frame>& frames,
                            const CameraState& start, const CameraOptions& options) {
  CameraBlocks blocks(start);
  ceres::Problem problem;
  build(session, frames, start, options, blocks, problem);
  ceres::Solver::Summary summary;
  ceres::Solve(solverOptions(options, blocks), &problem, &summary);
  CameraSolution solution;
  solution.state = stateFrom(start, blocks);
  solution.cost = summary.final_cost;
  solution.converged = summary.termination_type == ceres::CONVERGENCE;
  solution.iterations = static_cast<int>(summary.iterations.size());
  if (options.covariance) solution.covariance = covarianceOf(problem, blocks);
  return solution;
}

Eigen::VectorXd difference(const CameraState& to, const CameraState& from) {
  std::vector<double> all;
  for (std::size_t c = 0; c < to.cameras.size(); ++c) {
    const Eigen::VectorXd d =
        to.cameras[c].intrinsics.stacked() - from.cameras[c].intrinsics.stacked();
    all.insert(all.end(), d.data(), d.data() + d.size());
  }
  for (std::size_t c = 1; c < to.cameras.size(); ++c) {
    const Vector6d d = boxminus(to.cameras[c].T_C0Ci, from.cameras[c].T_C0Ci);
    all.insert(all.end(), d.data(), d.data() + 6);
  }
  return Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<int>(all.size()));
}

}  // namespace plumbline::oracle
