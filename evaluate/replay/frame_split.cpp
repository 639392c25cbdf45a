// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/frame_split.h"

#include "calibrator/base/error.h"
#include "calibrator/base/frames.h"

namespace plumbline {
namespace {

/// Blocks of equal length from a first stamp on.
class Blocks {
 public:
  Blocks(TimeNs first, const FrameSplitOptions& options)
      : first_(first), block_(toNanoseconds(options.block_s)), every_(options.held_out_every) {}

  bool isHeldOut(TimeNs t) const {
    if (t < first_) return false;
    return ((t - first_) / block_ + 1) % every_ == 0;
  }
  /// A held-out block begins or ends less than `guard` away.
  bool isNearHeldOut(TimeNs t, TimeNs guard) const {
    return isHeldOut(t - guard) || isHeldOut(t + guard);
  }

 private:
  TimeNs first_;
  TimeNs block_;
  int every_;
};

void check(const FrameSplitOptions& options) {
  if (!(options.block_s > 1e-3)) throw InputError("frames are parted in blocks of more than 1 ms");
  if (options.held_out_every < 2) {
    throw InputError("of every 2 or more blocks one can be held out, not of fewer");
  }
  if (!(options.guard_s >= 0 && options.guard_s < options.block_s)) {
    throw InputError("the guard beside a held-out block must be shorter than a block");
  }
}

}  // namespace

FrameSplit splitFrames(const Session& session, const FrameSplitOptions& options) {
  check(options);
  FrameSplit split;
  const std::vector<Frame> frames = pairFrames(session.cameras);
  if (frames.empty()) return split;
  const Blocks blocks(frames.front().t, options);
  const TimeNs guard = toNanoseconds(options.guard_s);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    if (blocks.isHeldOut(frames[f].t)) {
      split.held_out.push_back(static_cast<int>(f));
    } else if (!blocks.isNearHeldOut(frames[f].t, guard)) {
      split.pool.push_back(static_cast<int>(f));
    }
  }
  return split;
}

}  // namespace plumbline
