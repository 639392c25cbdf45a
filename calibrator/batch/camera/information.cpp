// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera/information.h"

#include <algorithm>
#include <utility>

#include "calibrator/base/calibration.h"
#include "calibrator/base/parallel.h"
#include "calibrator/batch/camera/common_error.h"
#include "calibrator/batch/corners.h"
#include "calibrator/information/cluster_robust.h"
#include "calibrator/information/covariance.h"

namespace plumbline {
namespace {

/// x = (twist in camera c's frame, dk) as a function of (noise of tau, g).
Eigen::MatrixXd cameraRows(const ImpliedShift& shift, const CameraEstimate& estimate,
                           const CameraLayout& layout, std::size_t c) {
  const Transform T_CiC0 = estimate.T_C0Ci[c].inverse();
  const Matrix6d A = adjoint(T_CiC0);
  const int K = layout.intrinsics_size[c];
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(6 + K, 6 + layout.size);
  // The camera follows the rig's shift by the adjoint, its own T_C0Ci without lever arm
  // (problem.cpp).
  M.topLeftCorner<6, 6>() = A;
  M.topRightCorner(6, layout.size) = A * shift.A;
  M.block(6, 6 + layout.intrinsics[c], K, K).setIdentity();
  if (c > 0) {
    M.block<3, 3>(0, 6 + layout.T_C0Ci[c]) -= T_CiC0.R;
    M.block<3, 3>(3, 6 + layout.T_C0Ci[c] + 3) -= T_CiC0.R;
  }
  return M;
}

/// Gradient of one frame's cost in cameras and terms, its pose eliminated, without priors, and the
/// frame's share of the information.
void addFrame(const CameraProblem& one, const CameraEstimate& at, Eigen::Ref<Eigen::VectorXd> score,
              Eigen::MatrixXd& information) {
  const CameraNormals n = normalsAt(one, at);
  score = n.b;
  information += reducedInformation(n);
  // normalsAt() adds the prior to every frame's equations; it is no frame's own.
  if (at.target) {
    score.tail<kTargetTerms>() -= one.target->priorGradient(*at.target);
    information.bottomRightCorner<kTargetTerms, kTargetTerms>() -= one.target->information;
  }
  const PoseElimination R(n.H.front());
  score -= (R * n.P).transpose() * (R * n.b_pose);
}

ScorePieces piecesOf(const CameraProblem& problem, const CameraEstimate& estimate) {
  ScorePieces out(CameraLayout(estimate).size, problem.frameCount());
  parallelCalls(out.units(), problem.threads, [&](int u) {
    CameraProblem one = problem;
    one.threads = 1;
    one.prior = nullptr;
    CameraEstimate at = estimate;
    for (int f = out.firstOfUnit(u); f < out.firstOfUnit(u + 1); ++f) {
      one.frames = {problem.frames[f]};
      one.weights = {problem.weight(f)};
      at.T_C0F = {estimate.T_C0F[f]};
      addFrame(one, at, out.scores.col(f), out.information(u));
    }
  });
  return out;
}

}  // namespace

Result<CameraInformation> cameraInformation(const Session& session, const CameraStageResult& at,
                                            const CameraInformationOptions& options) {
  options.check();
  std::vector<PackedCorners> corners = usedCorners(session, at.frames, at.residuals);
  AprilGrid board = session.target;
  board.shape = at.target;
  for (PackedCorners& camera : corners) camera.place(board);
  CameraProblem problem;
  problem.corners = corners;
  problem.frames = at.frames;
  problem.pixel_sigma = options.pixel_sigma;
  // Re-weighted squares: with the loss' second derivative information might be negative.
  problem.gram = {options.cauchy_px, 0};
  problem.threads = options.threads;
  const CameraEstimate estimate = estimateOf(at.cameras, at.T_FC0);
  const CameraNormals normals = normalsAt(problem, estimate);

  const Eigen::MatrixXd information = reducedInformation(normals);
  const auto covariance = covarianceOf(information);
  const auto entropy = entropyNats(information);
  if (!covariance || !entropy) return Failure{FailureCode::kSessionInformationSingular};
  CameraInformation out;
  out.covariance = parameterCovariance(cameraParameters(at.cameras), *covariance);
  out.entropy_nats = *entropy;
  const auto shift = impliedShift(normals.H, normals.P, options.alignment);
  if (!shift) return Failure{FailureCode::kFramePosesFree};
  const CameraLayout layout(estimate.intrinsics);
  Eigen::MatrixXd joint = Eigen::MatrixXd::Zero(6 + layout.size, 6 + layout.size);
  // Of (noise of tau, g), which are independent: the rest of tau follows from g (ImpliedShift::A).
  joint.topLeftCorner<6, 6>() = shift->noise;
  joint.bottomRightCorner(layout.size, layout.size) = out.covariance.matrix;
  for (std::size_t c = 0; c < at.cameras.size(); ++c) {
    const Eigen::MatrixXd M = cameraRows(*shift, estimate, layout, c);
    out.projection.push_back(M * joint * M.transpose());
  }
  return out;
}

std::optional<RobustCovariance> robustCovariance(const CameraProblem& problem,
                                                 const CameraSolution& solution,
                                                 const std::optional<HigherShare>& share) {
  const auto bread = covarianceOf(reducedInformation(solution.normals));
  if (problem.frameCount() < kLeastBlocks || !bread) return std::nullopt;
  ScorePieces pieces = piecesOf(problem, solution.estimate);
  // Before the correlation is looked for: the higher terms take away what neighbours have of them.
  if (share) pieces.scores = share->eliminatedFrom(pieces.scores);
  auto robust = robustCovarianceOf(pieces, *bread);
  if (!robust) return std::nullopt;
  RobustCovariance& out = *robust;
  const auto addKnown = [&out](const Eigen::MatrixXd& part) {
    out.known = out.known.size() > 0 ? out.known + part : part;
    out.matrix += part;
  };
  if (solution.estimate.target) {
    const Eigen::MatrixXd gain = bread->rightCols<kTargetTerms>();
    addKnown(gain * problem.target->scatter * gain.transpose());
    if (share) addKnown(share->known);
  }
  if (problem.common_error_share > 0) {
    const Eigen::MatrixXd moves =
        commonErrorMoves(problem, solution.estimate, commonErrorPx(problem, solution.estimate));
    out.common = moves * moves.transpose();
    addKnown(out.common);
  }
  return robust;
}

}  // namespace plumbline
