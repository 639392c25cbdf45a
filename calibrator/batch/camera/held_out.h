// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/batch/camera/problem.h"

namespace plumbline {

/// Error of frames that a solution did not see: every n-th frame of a recording, cut into ten
/// blocks of time; odd blocks are scored with cameras and board of the even ones and the other way
/// round, only poses moving.
struct HeldOut {
  std::vector<double> cost;  ///< per block, per corner, after the loss [px^2]
  double squared = 0;        ///< sum of all [px^2]
  double corners = 0;
  int frames = 0;

  double rms() const;
};

/// Every n-th frame says as much (0.04 px in EuRoC's cameras).
inline constexpr int kFramesOfTest = 400;

/// The solver's options for solutions that are only compared: a tenth of a standard deviation.
MinimiserOptions roughSolver();

/// `from` starts both solutions and has the poses; they have a board of their own to that detail
/// (higher_terms.h). With kTwelve what the problem's board has besides stays.
HeldOut heldOut(const CameraProblem& problem, const CameraEstimate& from,
                BoardDetail detail = BoardDetail::kTwelve, int most_frames = kFramesOfTest,
                const MinimiserOptions& solver = roughSolver());

/// The frames on which heldOut() stands, with their poses.
struct CameraPart {
  CameraProblem problem;
  CameraEstimate estimate;
};
CameraPart testedPart(const CameraProblem& problem, const CameraEstimate& estimate,
                      int most_frames = kFramesOfTest);

/// A difference of costs over the blocks.
struct MeanGain {
  double mean = 0;  ///< of from - to [px^2]
  double std = 0;   ///< of that mean
};
MeanGain meanGain(const std::vector<double>& from, const std::vector<double>& to);

}  // namespace plumbline
