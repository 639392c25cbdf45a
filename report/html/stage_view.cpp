// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/stage_view.h"

#include <cmath>

namespace plumbline::html_internal {

std::vector<std::vector<double>> frameRmse(const StageView& stage) {
  const std::size_t frames = stage.frames.size();
  std::vector<std::vector<double>> sums(stage.cameras.size(), std::vector<double>(frames, 0));
  auto counts = sums;
  for (const CornerResidual& r : stage.residuals) {
    const auto camera = static_cast<std::size_t>(r.camera);
    const auto frame = static_cast<std::size_t>(r.frame);
    if (!r.used || camera >= sums.size() || frame >= frames) continue;
    sums[camera][frame] += static_cast<double>(r.error.squaredNorm());
    counts[camera][frame] += 1;
  }
  for (std::size_t c = 0; c < sums.size(); ++c) {
    for (std::size_t f = 0; f < frames; ++f) {
      sums[c][f] = counts[c][f] > 0 ? std::sqrt(sums[c][f] / counts[c][f]) : std::nan("");
    }
  }
  return sums;
}

std::vector<double> frameSeconds(const std::vector<Frame>& frames) {
  std::vector<double> seconds;
  seconds.reserve(frames.size());
  for (const Frame& frame : frames) seconds.push_back(secondsBetween(frames.front().t, frame.t));
  return seconds;
}

}  // namespace plumbline::html_internal
