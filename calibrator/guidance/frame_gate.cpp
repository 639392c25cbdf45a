// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/frame_gate.h"

#include <utility>

#include <fmt/format.h>

namespace plumbline {
namespace {

// Pauses, in max_frame_gap_s, from which a stamp is doubted until the next frame confirms it.
constexpr double kFarPauses = 10;

}  // namespace

/// Whether a stamp is far after that of the frame before, and no frame that was held back for the
/// same reason just before confirms it.
bool FrameGate::isDoubtful(TimeNs t) {
  const double far_s = kFarPauses * max_gap_s_;
  const std::optional<TimeNs> held = std::exchange(doubted_, std::nullopt);
  if (pause_s_ <= far_s) return false;
  if (held && t > *held && secondsBetween(*held, t) <= far_s) return false;
  doubted_ = t;
  return true;
}

bool FrameGate::arrives(const GuideFrame& frame, std::optional<OpenSuggestion>& open, Decision& d) {
  // The first frame comes 1 ns after nothing: neither a jump nor a pause.
  const TimeNs before = last_.value_or(frame.t - 1);
  pause_s_ = last_ ? secondsBetween(before, frame.t) : 0;
  if (frame.t <= before) {
    d.reason = GuideReason::kTimeJump;
    note(d, frame.t == before
                ? "its stamp is not after that of the frame before: not used"
                : fmt::format("its stamp is {:.6f} s before that of the frame before: not used",
                              -pause_s_));
    return false;
  }
  if (isDoubtful(frame.t)) {
    d.reason = GuideReason::kTimeJump;
    note(d, fmt::format("its stamp is {:.6f} s after that of the frame before and may be wrong: "
                        "not used",
                        pause_s_));
    return false;
  }
  // Before the answer: frames that come while the guide is busy are no pause of the camera.
  last_ = frame.t;
  if (isAfterPause()) {
    note(d, fmt::format("no frame for {:.3f} s before it", pause_s_));
    // Nobody saw where the camera was meanwhile.
    if (open) open->update(before, {});
  }
  if (frame.t >= busy_until_) return true;
  d.reason = GuideReason::kBusy;
  return false;
}

bool FrameGate::hasTarget(bool shows, Decision& d) {
  // From the frame before the first without it, also where that was dropped: of the time of work,
  // or of a pause, nobody knows. A target that was never seen counts as lost from the first frame
  // on.
  if (!shows && (!lost_since_ || (isAfterPause() && !lost_said_))) {
    lost_since_ = isAfterPause() ? d.t : d.t - toNanoseconds(pause_s_);
  }
  const double lost_s = lost_since_ ? secondsBetween(*lost_since_, d.t) : 0;
  if (shows) {
    if (std::exchange(lost_said_, false)) {
      note(d, fmt::format("the target is back after {:.3f} s out of view", lost_s));
    }
    lost_since_.reset();
    return true;
  }
  d.reason = GuideReason::kNoTarget;
  if (!lost_said_ && lost_s > lost_target_s_) {
    lost_said_ = true;
    note(d, fmt::format("the target has been out of view for {:.3f} s", lost_s));
  }
  return false;
}

}  // namespace plumbline
