// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/frame_gate.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace plumbline {
namespace {

// A stamp so many max_frame_gap_s from the frame before is doubted until the next frame confirms
// it.
constexpr double kFarPauses = 10;
// But not a nearer one [s]: frames of a slow camera are seconds apart where some are lost, also
// where a short max_frame_gap_s is asked for.
constexpr double kLeastFarS = 5;

}  // namespace

FrameGate::FrameGate(const GuideOptions& options, TimeNs busy_until, std::optional<TimeNs> last)
    : lost_target_s_(options.lost_target_s),
      max_gap_s_(options.max_frame_gap_s),
      far_s_(std::max(kFarPauses * options.max_frame_gap_s, kLeastFarS)),
      busy_until_(busy_until),
      last_(last) {}

/// Nothing that the first frame's stamp began goes on.
void FrameGate::startAnew(TimeNs t, std::optional<OpenSuggestion>& open) {
  since_ = busy_until_ = t;
  lost_since_.reset();
  lost_said_ = false;
  if (open) open->restart(t);
}

/// Whether the frame's stamp is to be believed; says in `d` why not. `before` is the stamp of the
/// frame before it.
bool FrameGate::isInOrder(TimeNs t, TimeNs before, Decision& d) {
  const std::optional<TimeNs> held = std::exchange(doubted_, std::nullopt);
  const bool far = std::abs(pause_s_) > far_s_;
  const bool confirms = far && held && t > *held && secondsBetween(*held, t) <= far_s_;
  replaces_first_ = confirms && is_only_;
  if (replaces_first_) {
    note(d, fmt::format("time begins anew: the only frame before is {:.3f} s {} it",
                        std::abs(pause_s_), pause_s_ > 0 ? "before" : "after"));
    pause_s_ = secondsBetween(*held, t);
    return true;
  }
  if (t > before && (!far || confirms)) return true;
  // Also far before the only frame, which may be the one that is wrong.
  if (far && (t > before || is_only_)) doubted_ = t;
  d.reason = GuideReason::kTimeJump;
  if (t > before) {
    note(d, fmt::format("its stamp is {:.6f} s after that of the frame before and may be wrong: "
                        "not used",
                        pause_s_));
  } else {
    note(d, t == before
                ? "its stamp is not after that of the frame before: not used"
                : fmt::format("its stamp is {:.6f} s before that of the frame before: not used",
                              -pause_s_));
  }
  return false;
}

bool FrameGate::arrives(const GuideFrame& frame, std::optional<OpenSuggestion>& open, Decision& d) {
  // The first frame comes 1 ns after nothing: neither a jump nor a pause.
  const TimeNs before = last_.value_or(frame.t - 1);
  pause_s_ = last_ ? secondsBetween(before, frame.t) : 0;
  if (!isInOrder(frame.t, before, d)) return false;
  if (replaces_first_) startAnew(frame.t, open);
  if (!since_) since_ = frame.t;
  // Before the answer: frames that come while the guide is busy are no pause of the camera.
  is_only_ = !last_;
  last_ = frame.t;
  if (isAfterPause()) {
    note(d, fmt::format("no frame for {:.3f} s before it", pause_s_));
    // Nobody saw where the camera was meanwhile.
    if (open && !replaces_first_) open->update(before, {});
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
