// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera/information.h"

#include "calibrator/base/calibration.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/batch/corners.h"
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
  if (!covariance || !entropy) {
    return Failure{FailureCode::kSessionInformationSingular};
  }
  CameraInformation out;
  out.covariance = parameterCovariance(cameraParameters(at.cameras), *covariance);
  out.entropy_nats = *entropy;
  const auto shift = impliedShift(normals.H, normals.P, options.alignment);
  if (!shift) {
    return Failure{FailureCode::kFramePosesFree};
  }
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

}  // namespace plumbline
