// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/board/board_system.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <memory>

#include "calibrator/batch/board/higher_terms.h"
#include "calibrator/batch/camera/stage.h"
#include "calibrator/dense/decompositions.h"

namespace plumbline {
namespace {

/// Normal equations in the board's unknowns about `at`.
struct BoardNormals {
  Eigen::MatrixXd S;
  Eigen::VectorXd s;
  Eigen::VectorXd at;
};

/// Of the board alone: its prior taken out, the cameras eliminated.
std::optional<BoardNormals> boardNormals(const CameraProblem& problem,
                                         const CameraEstimate& estimate) {
  JointSystem joint = jointSystem(problem, estimate, BoardDetail::kHigher);
  const TargetTerms& terms = *estimate.target;
  const Eigen::Index cameras = joint.S_gg.rows() - kTargetTerms;
  joint.S_gg.bottomRightCorner<kTargetTerms, kTargetTerms>() -= problem.target->information;
  joint.s_g.tail<kTargetTerms>() -= problem.target->priorGradient(terms);
  Eigen::MatrixXd S(kBoardUnknowns, kBoardUnknowns);
  S << joint.S_gg.bottomRightCorner<kTargetTerms, kTargetTerms>(),
      joint.S_gh.bottomRows<kTargetTerms>(), joint.S_gh.bottomRows<kTargetTerms>().transpose(),
      joint.S_hh;
  Eigen::VectorXd s(kBoardUnknowns);
  s << joint.s_g.tail<kTargetTerms>(), joint.scores.rowwise().sum();
  Eigen::MatrixXd with_cameras(cameras, kBoardUnknowns);
  with_cameras << joint.S_gg.topRightCorner(cameras, kTargetTerms), joint.S_gh.topRows(cameras);
  const Eigen::LLT<Eigen::MatrixXd> llt(joint.S_gg.topLeftCorner(cameras, cameras));
  if (llt.info() != Eigen::Success) return std::nullopt;
  // S - S_bc S_cc^-1 S_cb and s - S_bc S_cc^-1 s_c, as products that are symmetric.
  const Eigen::MatrixXd W = llt.matrixL().solve(with_cameras);
  const Eigen::VectorXd w = llt.matrixL().solve(joint.s_g.head(cameras));
  BoardNormals out{S - W.transpose() * W, s - W.transpose() * w,
                   Eigen::VectorXd::Zero(kBoardUnknowns)};
  out.at.head<kTargetTerms>() = terms;
  return out;
}

/// By how much the cluster-robust deviations are larger than the formal ones at the measured noise,
/// per column.
Eigen::VectorXd stretchOf(const CameraStageResult& stage, double ratio) {
  if (!stage.robust_covariance) return Eigen::VectorXd::Ones(kBoardUnknowns);
  const TargetTerms formal = ratio * stage.target_fit->shape.covariance->diagonal();
  const TargetTerms robust = stage.robust_covariance->matrix.diagonal().tail<kTargetTerms>();
  const TargetTerms squares = robust.cwiseQuotient(formal).cwiseMax(1);
  Eigen::VectorXd out(kBoardUnknowns);
  out.setConstant(std::sqrt(squares.head<kBoardTerms>().mean()));
  out.head<kTargetTerms>() = squares.cwiseSqrt();
  return out;
}

/// S = V L V^T, so that A = L^1/2 V^T; what rounding leaves of a null space is left out. The
/// solution of S (x - at) = -s keeps its place when the columns are stretched about it.
BoardSystem whitened(const BoardNormals& normals, double ratio, const Eigen::VectorXd& stretch) {
  // All unknowns are displacements in metres, so that eigenvalues compare.
  constexpr double kRounding = 1e-12;  // of the largest eigenvalue
  const SymmetricEigen eigen = symmetricEigen(normals.S);
  const double least = kRounding * eigen.values[kBoardUnknowns - 1];
  BoardSystem out{Eigen::MatrixXd::Zero(kBoardUnknowns, kBoardUnknowns), {}};
  Eigen::VectorXd best = normals.at;
  for (Eigen::Index i = 0; i < kBoardUnknowns; ++i) {
    const double value = eigen.values[i];
    if (value <= least) continue;
    const Eigen::VectorXd mode = eigen.vectors.col(i);
    best -= mode * (mode.dot(normals.s) / value);
    out.A.row(i) = std::sqrt(value / ratio) * mode.cwiseQuotient(stretch).transpose();
  }
  out.b = out.A * best;
  return out;
}

}  // namespace

std::optional<BoardSystem> boardSystem(const Session& session, const CameraStageResult& stage,
                                       const CameraStageOptions& options) {
  if (!stage.target_fit || !stage.target_fit->shape.covariance) return std::nullopt;
  const std::vector<PackedCorners> corners = usedCorners(session, stage.frames, stage.residuals);
  CameraProblem problem = problemOf(corners, stage.frames, options);
  AprilGrid board = session.target;
  // About the even grid: the twelve terms are the estimate's, the higher ones zero.
  board.shape = {};
  problem.target = std::make_shared<TargetModel>(board);
  CameraEstimate estimate = estimateOf(stage.cameras, stage.T_FC0);
  estimate.target = stage.target_fit->shape.terms;
  const auto normals = boardNormals(problem, estimate);
  if (!normals) return std::nullopt;
  // RMSE is of |e|: per axis it is less by sqrt(2).
  const double noise_px =
      std::max(stage.summary.reprojection.rmse_px / std::sqrt(2), kLeastNoisePx);
  const double ratio = std::pow(noise_px / options.pixel_sigma, 2);
  return whitened(*normals, ratio, stretchOf(stage, ratio));
}

}  // namespace plumbline
