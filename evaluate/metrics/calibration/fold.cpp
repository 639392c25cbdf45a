// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/calibration/fold.h"

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "calibrator/base/time.h"

namespace plumbline {
namespace {

/// Removes the IMU samples strictly between two instants of the cameras' clock.
void cutBetween(TimeNs from, TimeNs to, double time_offset_s, Session& session) {
  if (!session.imu) return;
  const TimeNs offset = toNanoseconds(time_offset_s);
  std::erase_if(session.imu->samples, [&](const ImuSample& sample) {
    return sample.t > from + offset && sample.t < to + offset;
  });
}

}  // namespace

Fold foldOf(const Session& session, const FrameOptions& options, const FoldChoice& choice) {
  const int index = choice.index, count = choice.count;
  assert(count >= 2 && index >= 0 && index < count);
  const auto frames = pairFrames(session.cameras, options);
  const auto n = static_cast<std::int64_t>(frames.size());
  // Floors of n index / count: lengths differ by one at most, and no frame falls between two runs.
  const auto first = static_cast<int>(n * index / count);
  const auto end = static_cast<int>(n * (index + 1) / count);
  // Held out as one run in time: frames next to each other are alike, and single ones would be
  // predicted by their neighbours.
  std::vector<int> training, held_out;
  for (int f = 0; f < static_cast<int>(n); ++f) {
    (f >= first && f < end ? held_out : training).push_back(f);
  }
  Fold fold{withFrames(session, frames, training), withFrames(session, frames, held_out)};
  if (end > first) {
    cutBetween(frames[static_cast<std::size_t>(first)].t,
               frames[static_cast<std::size_t>(end) - 1].t, choice.time_offset_s, fold.training);
  }
  return fold;
}

}  // namespace plumbline
