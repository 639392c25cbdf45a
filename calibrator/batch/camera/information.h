// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/batch/board/higher_terms.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/information/projection_uncertainty.h"

namespace plumbline {

/// The loss of the measurement model weights the corners.
struct CameraInformationOptions : MeasurementModel {
  FrameAlignment alignment = FrameAlignment::kCrossReprojection;
  int threads = 1;  ///< results do not depend on it
};

/// What a session tells of cameras, linearised at their given values.
struct CameraInformation {
  ParameterCovariance covariance;                ///< as of calibrateCameras(): poses marginalised
  double entropy_nats = 0;                       ///< of `covariance`
  std::vector<ProjectionCovariance> projection;  ///< one per camera
};

/// Information of the used corners of `at` (from calibrateCameras() or scoreCameras() on the same
/// session) at its cameras and poses; nothing is estimated. For two calibrations of one rig the
/// entropies compare, since list, noise and corners are the same.
/// With A_i the adjoint of T_CiC0, the twist of the points in camera i's frame is
///   A_i tau + diag(-R_CiC0, -R_CiC0) e_i,   e_i the tangent of T_C0Ci,
/// tau as in information/projection_uncertainty.h. Fails with kNotObservable.
Result<CameraInformation> cameraInformation(const Session& session, const CameraStageResult& at,
                                            const CameraInformationOptions& options = {});

/// Cluster-robust ("sandwich") covariance of the cameras' parameters and the board's terms: with
/// the reduced information S and the scores s_b of M blocks of time (gradient of their cost, poses
/// eliminated), adjusted for the block's leverage (clusterRobust()),
///   S^-1 (sum_b u_b u_b^T) S^-1,   u_b = (I - H_b S^-1)^(-1/2) s_b,
/// and S^-1 scatter S^-1 of what a known board's terms may be off by (TargetModel::scatter), and
/// M M^T of commonErrorMoves() at commonErrorPx().
/// It holds where corners err together within a block, or the model misfits: then the formal S^-1
/// promises too much (Liang and Zeger 1986; White 1982). Both agree for white noise, on recordings
/// of any length.
///
/// Computed at a solution. Blocks are equally many consecutive frames: two correlation lengths of
/// the scores, where those are correlated, and 40 blocks at most; what neighbouring blocks share is
/// made up for as if the correlation fell exponentially. Empty where there are fewer than 6 frames,
/// or S is singular.
///
/// With `share` the board's higher terms are estimated, not fixed: their part of the scores, and of
/// what their prior may be off by.
std::optional<RobustCovariance> robustCovariance(const CameraProblem& problem,
                                                 const CameraSolution& solution,
                                                 const std::optional<HigherShare>& share = {});

}  // namespace plumbline
