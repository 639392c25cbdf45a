// SPDX-License-Identifier: BSD-3-Clause
// Joining what sessions say of a board against one bundle adjustment of all of them by Ceres.
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include <ceres/covariance.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/numeric_diff_cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <gtest/gtest.h>

#include "calibrator/batch/board/board_system.h"
#include "calibrator/batch/board/joint_target.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/camera/camera.h"
#include "calibrator/residuals/packed_corners.h"
#include "calibrator/simulate/simulate_session.h"
#include "tests/calibrator/oracle/reprojection_cost.h"

namespace plumbline {
namespace {

constexpr int kBoard = kTargetTerms - 1;
constexpr double kNoisePx = 0.2;
using BoardVector = Eigen::Matrix<double, kBoard, 1>;

/// One camera's recording of 6 s, and its camera stage without cluster-robust deviations, which
/// would weigh the terms of each session otherwise than its noise does.
struct Recorded {
  Session session;
  CameraStageResult stage;
  CameraStageOptions options;
};

Recorded recorded(const TargetTerms& terms, std::uint64_t seed) {
  SimulationOptions options;
  options.target.shape.terms = terms;
  options.seed = options.trajectory.seed = seed;
  options.duration_s = 6;
  options.camera_rate_hz = 2;
  options.corner_sigma_px = kNoisePx;
  Recorded out;
  out.session = simulateSession(simulatedRig("euroc"), options).session;
  out.session.target.shape = {};
  out.session.cameras.resize(1);
  out.options.target = TargetMode::kEstimate;
  out.options.cauchy_px = 0;
  auto stage = calibrateCameras(out.session, out.options);
  EXPECT_TRUE(stage.ok());
  out.stage = std::move(stage).value();
  out.stage.robust_covariance.reset();
  return out;
}

/// A corner of a bent board in a camera: intrinsics, T_CF, the board's terms, tag_edge.
struct BentCorner {
  Intrinsics lens;
  Eigen::Vector3d p_F;
  Eigen::Matrix<double, 3, kTargetTerms> B;
  Eigen::Vector2d uv;

  bool operator()(const double* k, const double* T_CF, const double* terms, const double* edge,
                  double* e) const {
    Intrinsics camera = lens;
    camera.setStacked(Eigen::Map<const Eigen::Matrix<double, 8, 1>>(k));
    const Eigen::Vector3d p =
        p_F + B.leftCols<kBoard>() * Eigen::Map<const BoardVector>(terms) + B.col(kBoard) * *edge;
    const Eigen::Quaterniond q(T_CF + 3);
    const auto seen = project(camera, q * p + Eigen::Map<const Eigen::Vector3d>(T_CF));
    if (!seen) return false;
    Eigen::Map<Eigen::Vector2d>{e} = (*seen - uv) / kNoisePx;
    return true;
  }
};
using BentCornerCost =
    ceres::NumericDiffCostFunction<BentCorner, ceres::CENTRAL, 2, 8, 7, kBoard, 1>;

/// Every term 0 +- 5 mm.
struct WeakPrior {
  bool operator()(const double* terms, double* e) const {
    for (int j = 0; j < kBoard; ++j) e[j] = terms[j] / TargetModel::prior_std;
    return true;
  }
};

/// The parameters that a session has of its own.
struct OwnBlocks {
  std::array<double, 8> intrinsics;
  std::vector<PoseBlock> T_CF;
  double edge;
};

void addSession(const Recorded& r, OwnBlocks& own, double* terms, ceres::Problem& problem) {
  const AprilGrid& grid = r.session.target;
  const TargetBasis basis(grid);
  const PackedCorners packed(grid, r.session.cameras[0].views);
  for (std::size_t f = 0; f < r.stage.frames.size(); ++f) {
    const int index = r.stage.frames[f].view[0];
    const ImageView& view = r.session.cameras[0].views[static_cast<std::size_t>(index)];
    const double* scale = packed.view(index).edge;
    for (std::size_t k = 0; k < view.corners.size(); ++k) {
      const Corner& corner = view.corners[k];
      BentCorner cost{r.stage.cameras[0].intrinsics, Eigen::Vector3d::Zero(),
                      basis.columns(corner.id), corner.uv};
      cost.p_F.head<2>() = grid.corner(corner.id);
      cost.B.col(kBoard) *= scale[k];
      problem.AddResidualBlock(new BentCornerCost(new BentCorner(cost)), nullptr,
                               own.intrinsics.data(), own.T_CF[f].data(), terms, &own.edge);
    }
    problem.SetManifold(own.T_CF[f].data(), makePoseManifold().release());
  }
}

struct JointBoard {
  BoardVector terms, std;
};

/// All sessions at once: cameras and poses of each, one board.
JointBoard bundleAdjusted(const std::vector<Recorded>& sessions) {
  BoardVector terms = BoardVector::Zero();
  std::vector<OwnBlocks> own(sessions.size());
  ceres::Problem problem;
  for (std::size_t s = 0; s < sessions.size(); ++s) {
    const CameraStageResult& stage = sessions[s].stage;
    Eigen::Map<Eigen::VectorXd>(own[s].intrinsics.data(), 8) =
        stage.cameras[0].intrinsics.stacked();
    for (const Transform& T_FC0 : stage.T_FC0) {
      own[s].T_CF.push_back(poseBlockFrom(T_FC0.inverse()));
    }
    own[s].edge = 0;
    addSession(sessions[s], own[s], terms.data(), problem);
  }
  problem.AddResidualBlock(
      new ceres::NumericDiffCostFunction<WeakPrior, ceres::CENTRAL, kBoard, kBoard>(new WeakPrior),
      nullptr, terms.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  options.logging_type = ceres::SILENT;
  options.function_tolerance = 1e-12;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  EXPECT_EQ(summary.termination_type, ceres::CONVERGENCE);
  ceres::Covariance covariance({});
  EXPECT_TRUE(covariance.Compute(
      {std::pair<const double*, const double*>(terms.data(), terms.data())}, &problem));
  Eigen::Matrix<double, kBoard, kBoard, Eigen::RowMajor> C;
  covariance.GetCovarianceBlock(terms.data(), terms.data(), C.data());
  return {terms, C.diagonal().cwiseSqrt()};
}

TEST(JointTargetOracle, IsTheBundleAdjustmentOfAllSessions) {
  TargetTerms terms = TargetTerms::Zero();
  terms[0] = 8e-4;   // stretch
  terms[3] = 5e-4;   // keystone
  terms[8] = -1e-3;  // bow
  std::vector<Recorded> sessions;
  std::vector<BoardSystem> systems;
  for (const std::uint64_t seed : {1, 2}) {
    sessions.push_back(recorded(terms, seed));
    const Recorded& r = sessions.back();
    systems.push_back(*boardSystem(r.session, r.stage, r.options));
  }
  const JointTarget joint = joinTargets(systems, {.degree = 2});
  const JointBoard oracle = bundleAdjusted(sessions);
  const BoardVector d = joint.shape.terms.head<kBoard>() - oracle.terms;
  EXPECT_LT(d.cwiseQuotient(oracle.std).cwiseAbs().maxCoeff(), 0.1);
  const BoardVector std =
      (joint.shape.covariance->diagonal().head<kBoard>() / joint.dispersion).cwiseSqrt();
  for (int j = 0; j < kBoard; ++j) EXPECT_NEAR(std[j] / oracle.std[j], 1, 0.05) << j;
}

}  // namespace
}  // namespace plumbline
