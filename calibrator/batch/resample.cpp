// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/resample.h"

#include <algorithm>
#include <cassert>
#include <random>

#include "calibrator/base/option_check.h"
#include "calibrator/base/parallel.h"

namespace plumbline {

void ResampleOptions::check() const {
  requireAtLeast(2, "draws", draws);
  requireAtLeast(2, "segments", segments);
  requireAtLeast(1, "threads", threads);
}

std::vector<FrameSegment> drawSegments(int frame_count, const ResampleOptions& options, int draw) {
  const int count = std::min(options.segments, frame_count);
  std::vector<FrameSegment> segments;
  if (count <= 0) return segments;
  std::vector<int> drawn(count, 0);
  // Random numbers of one draw, unlike those of any other seed or draw.
  std::seed_seq words{static_cast<std::uint32_t>(options.seed),
                      static_cast<std::uint32_t>(options.seed >> 32),
                      static_cast<std::uint32_t>(draw)};
  std::mt19937_64 random(words);
  // A bootstrap of blocks that do not overlap (Carlstein 1986), of about equal length.
  // As many draws as segments, with replacement. A segment that is drawn k times counts k times: it
  // enters once with weight k, which costs no more than once.
  for (int i = 0; i < count; ++i) ++drawn[random() % drawn.size()];
  const auto first = [&](int s) {
    // In 64 bits: the product may be more than an int.
    return static_cast<int>(static_cast<std::int64_t>(frame_count) * s / count);
  };
  for (int s = 0; s < count; ++s) {
    const int times = drawn[s];
    if (times == 0) continue;
    segments.push_back({first(s), first(s + 1) - first(s), static_cast<double>(times)});
  }
  return segments;
}

ResampleSummary summariseDraws(const ParameterCovariance& parameters, const Eigen::MatrixXd& draws,
                               int failed) {
  assert(static_cast<std::size_t>(draws.rows()) == parameters.names.size());
  ResampleSummary summary{parameters.names, parameters.units, Eigen::VectorXd::Zero(draws.rows()),
                          draws, failed};
  if (draws.cols() < 2) return summary;
  const Eigen::MatrixXd centred = draws.colwise() - draws.rowwise().mean();
  summary.std =
      (centred.rowwise().squaredNorm() / static_cast<double>(draws.cols() - 1)).cwiseSqrt();
  return summary;
}

Result<ResampleSummary> solveDraws(const ParameterCovariance& parameters, int frame_count,
                                   const ResampleOptions& options, const std::string& stage,
                                   const DrawSolver& solve) {
  options.check();
  // Draws side by side rather than threads within a draw: they share nothing.
  const auto solved = parallelMap(options.draws, options.threads, [&](int draw) {
    return solve(drawSegments(frame_count, options, draw));
  });
  Eigen::MatrixXd draws(parameters.names.size(), solved.size());
  // In the order of the draws, whatever thread solved them.
  int count = 0;
  for (const auto& draw : solved) {
    if (draw) draws.col(count++) = *draw;
  }
  const int failed = options.draws - count;
  if (count < 2) return Failure{FailureCode::kTooFewDraws, {{"stage", stage}, {"failed", failed}}};
  return summariseDraws(parameters, draws.leftCols(count), failed);
}

}  // namespace plumbline
