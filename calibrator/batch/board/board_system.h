// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera/batch.h"

namespace plumbline {

/// The twelve terms of a board, then those of degrees 3 and 4 (TargetShape).
inline constexpr int kBoardUnknowns = kTargetTerms + kHigherTerms;

/// What one recording says of its board: whitened equations A x = b + noise of unit variance, in
/// the unknowns x [m], 39 columns. Cameras and poses are eliminated, no prior is in it; directions
/// that the recording does not determine are in the null space of A.
struct BoardSystem {
  Eigen::MatrixXd A;
  Eigen::VectorXd b;
};

/// Of a camera stage that estimated the twelve terms of a board as stated (TargetMode::kEstimate),
/// linearised at its solution x0, the higher terms at zero. With S and s information and gradient
/// in x, all else eliminated,
///   A^T A = D^-1 S D^-1 / r,   b = A x for the x with S (x - x0) = -s.
/// r brings the corners' stated noise to that which they have, RMSE^2 / (2 pixel_sigma^2): a stated
/// noise that is too large would let any two boards agree. D, diagonal, is by how much a term's
/// cluster-robust deviation exceeds the formal one (at least 1); for the higher terms the RMS of
/// that over the board's eleven. Empty where the stage estimated no terms, or the cameras are not
/// determined.
std::optional<BoardSystem> boardSystem(const Session& session, const CameraStageResult& stage,
                                       const CameraStageOptions& options);

}  // namespace plumbline
