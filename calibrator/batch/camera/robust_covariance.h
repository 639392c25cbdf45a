// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "calibrator/base/statistics/robust_covariance.h"
#include "calibrator/batch/board/higher_terms.h"
#include "calibrator/batch/camera/problem.h"

namespace plumbline {

/// Cluster-robust ("sandwich") covariance of the cameras' parameters and the board's terms: with
/// the reduced information S and the scores s_b of M blocks of time (gradient of their cost, poses
/// eliminated), adjusted for the block's leverage (clusterRobust()),
///   S^-1 (sum_b u_b u_b^T) S^-1,   u_b = (I - H_b S^-1)^(-1/2) s_b,
/// and S^-1 scatter S^-1 of what a known board's terms may be off by (TargetModel::scatter).
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
