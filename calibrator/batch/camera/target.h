// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibrator/base/results.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/problem.h"

namespace plumbline {

/// A solution, and what it says of the board where that was asked for.
struct TargetSolution {
  CameraSolution solution;
  std::optional<TargetFit> fit;
};

/// Frees the board's terms (options.target), from `flat`, the solution with the board as it is
/// stated, and keeps them where the recording determines and needs them:
///
/// - no term's standard deviation exceeds options.target_max_std;
/// - frames that the fit did not see are predicted better: the recording is cut into blocks of
/// time,
///   odd blocks are scored with cameras and board of the even ones and the other way round, only
///   poses moving, once with the terms and once without; the mean gain of a block in squared error
///   must exceed twice its standard deviation over the blocks. A board as stated gains nothing: its
///   terms add noise, so that the gain is below zero.
TargetSolution estimateTarget(const AprilGrid& board, CameraProblem& problem, CameraSolution flat,
                              const CameraStageOptions& options);

}  // namespace plumbline
