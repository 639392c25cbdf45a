// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/results.h"

namespace plumbline {

/// A segment of consecutive frames of an earlier result and how often it counts: the unit of a
/// bootstrap over time segments.
struct FrameSegment {
  int first = 0;
  int count = 0;
  double weight = 1;  ///< > 0; residuals of its frames count that often
};

/// A bootstrap over time: neighbouring frames share their errors, so whole segments are drawn.
struct ResampleOptions {
  int draws = 50;          ///< solutions
  int segments = 20;       ///< contiguous parts of about equal number of frames; as many are drawn
  std::uint64_t seed = 1;  ///< of the draws
  int threads = 1;         ///< results do not depend on it

  void check() const;  ///< throws InputError: two draws and segments at least
};

/// Spread of the parameters over the draws.
struct ResampleSummary {
  std::vector<std::string> names;  ///< as in the covariance
  std::vector<std::string> units;
  Eigen::VectorXd std;    ///< standard deviation over the draws (divisor n - 1)
  Eigen::MatrixXd draws;  ///< one column a draw: its parameters minus the full solution's
  int failed = 0;         ///< draws without a solution, left out
};

/// Draw number `draw`: as many of the segments as there are, with replacement; a segment drawn k
/// times is one segment of weight k. Ascending, not overlapping. Each draw has random numbers of
/// its own. The number of segments is reduced to `frame_count` where that is smaller.
std::vector<FrameSegment> drawSegments(int frame_count, const ResampleOptions& options, int draw);

/// Standard deviations over the columns of `draws`; `failed` counts those left out before.
ResampleSummary summariseDraws(const ParameterCovariance& parameters, const Eigen::MatrixXd& draws,
                               int failed);

/// Differences of the parameters of one draw from the full solution's; empty where it has none.
using DrawSolver = std::function<std::optional<Eigen::VectorXd>(const std::vector<FrameSegment>&)>;

/// Solves every draw of `frame_count` frames, shared out over the options' threads, and summarises
/// them; the order does not matter. Fails with kTooFewDraws if fewer than two have a solution;
/// `stage` names it in the message.
Result<ResampleSummary> solveDraws(const ParameterCovariance& parameters, int frame_count,
                                   const ResampleOptions& options, const std::string& stage,
                                   const DrawSolver& solve);

}  // namespace plumbline
