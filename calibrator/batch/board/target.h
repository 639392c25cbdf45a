// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/results.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/problem.h"

namespace plumbline {

/// What is known of the board's terms before a recording speaks. With TargetMode::kKnown the shape
/// in `board`: its terms with their covariance (1 um where it has none), but for tag_edge, which
/// belongs to recording and detector and is free; and its higher terms with their deviations, where
/// it has them. As the cost counts corners in units of
/// pixel_sigma, not of their noise, the prior is weakened (or strengthened) by as much: information
///   C^-1 noise^2 / pixel_sigma^2,   noise^2 = sum rho(|e|^2) / (2 corners) at `estimate`.
/// Otherwise nothing.
std::shared_ptr<const TargetModel> targetModel(const AprilGrid& board, TargetMode mode,
                                               const CameraProblem& problem,
                                               const CameraEstimate& estimate);

/// Mean square of the corners' errors per axis, after the loss, over pixel_sigma^2.
double noiseRatio(const CameraProblem& problem, const CameraEstimate& estimate);

/// The terms to start from: the board's, but for a known board tag_edge, 0.
TargetTerms startTerms(const AprilGrid& board, TargetMode mode);

/// A problem of an earlier result's corners solved again, once its frames stand: from `estimate`,
/// with the terms free that the earlier result estimated, from where it has them. Higher ones get
/// one step, which leaves a tenth of a standard deviation (higher_terms.h). A shape that it took as
/// given stays in the corners.
CameraSolution solveAgain(const Session& session, const CameraStageResult& earlier,
                          const CameraStageOptions& options, CameraProblem& problem,
                          CameraEstimate estimate);

/// Fills a fit's shape, with its deviations, from a solution with the board's terms: the formal
/// ones at the noise that the corners have, or the cluster-robust ones where those are larger
/// (`shape.covariance` is formal under pixel_sigma). False where it has none: it has not converged,
/// or does not determine cameras and board.
bool describeBoard(const CameraProblem& problem, const CameraSolution& bent, TargetFit& fit);

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
///
/// A board that is kept so gets terms of degrees 3 and 4 besides (higher_terms.h), where those
/// predict unseen frames better than the twelve alone, by the same test, and where these are kept,
/// remainders of single corners, where they in turn do; only with TargetMode::kAuto and
/// options.target_degree 4.
///
/// There is no verdict (TargetFinding::kNotTested) where a half of the blocks has no solution.
///
/// A known board (TargetMode::kKnown) is kept whatever comes out; the same test says whether terms
/// of its own do better.
TargetSolution estimateTarget(AprilGrid board, CameraProblem& problem, CameraSolution flat,
                              const CameraStageOptions& options);

}  // namespace plumbline
