// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/frame_split.h"

#include <cstddef>

#include "calibrator/base/error.h"

namespace plumbline {

void FrameSplitOptions::check() const {
  if (!(block_s > 1e-3)) throw InputError("frames are split into blocks of more than 1 ms");
  if (held_out_every < 2) {
    throw InputError("one of every 2 or more blocks can be held out, not of fewer");
  }
  if (!(guard_s >= 0 && guard_s < block_s)) {
    throw InputError("the guard beside a held-out block must be shorter than a block");
  }
}

FrameSplit splitFrames(const Session& session, const FrameSplitOptions& options,
                       const FrameOptions& pairing) {
  options.check();
  FrameSplit split;
  const std::vector<Frame> frames = pairFrames(session.cameras, pairing);
  if (frames.empty()) return split;
  const TimeNs first = frames.front().t, block = toNanoseconds(options.block_s);
  const TimeNs guard = toNanoseconds(options.guard_s);
  const auto is_held_out = [&](TimeNs t) {
    // The last block of every so many, so that a recording shorter than that holds nothing out.
    return t >= first && ((t - first) / block + 1) % options.held_out_every == 0;
  };
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const TimeNs t = frames[f].t;
    // A guard is shorter than a block, so no held-out block lies between t and its ends.
    if (is_held_out(t)) {
      split.held_out.push_back(static_cast<int>(f));
    } else if (!is_held_out(t - guard) && !is_held_out(t + guard)) {
      split.pool.push_back(static_cast<int>(f));
    }
  }
  return split;
}

std::vector<int> thinned(const std::vector<int>& frames, int most) {
  if (static_cast<int>(frames.size()) <= most) return frames;
  std::vector<int> kept;
  for (int i = 0; i < most; ++i) {
    kept.push_back(frames[frames.size() * i / most]);
  }
  return kept;
}

}  // namespace plumbline
