// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrator/batch/camera_imu/effective_terms.h"
#include "calibrator/batch/camera_imu/fault_search.h"

namespace plumbline {

/// Score and information of a piece of the recording about the border's and the faults' columns,
/// with all states adapting: with J the whitened Jacobian, r the residual, W = dx/dB the response
/// of the states, J~ = J_B + J_x W:   gradient = sum J~' r,   information = sum J~' J~.
struct ScoreBlock {
  TimeNs begin = 0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd information;
};

struct EffectiveScores {
  std::vector<ScoreBlock> blocks;
  double sway_hz = 0;  ///< frequency at which the forces left over in F are largest
  JumpPlaces jumps;
};

/// In blocks of about `block_s` seconds. Empty where the system has no inverse or samples do not
/// cover a window.
std::optional<EffectiveScores> effectiveScores(const CameraImuProblem& problem,
                                               const CameraImuSolution& solution,
                                               const FaultColumns& columns, double block_s);

}  // namespace plumbline
