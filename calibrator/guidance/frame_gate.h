// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <optional>

#include "calibrator/base/guide_decision.h"
#include "calibrator/guidance/guide_options.h"
#include "calibrator/guidance/open_suggestion.h"

namespace plumbline {

/// Which frames a stage of the guide looks at: those whose stamp is after all before, that come
/// when it is not busy, and that show the target. What holds a frame back, a pause before it, and a
/// target that is long out of view are said in the decision.
class FrameGate {
 public:
  explicit FrameGate(const GuideOptions& options,
                     TimeNs busy_until = std::numeric_limits<TimeNs>::min())
      : lost_target_s_(options.lost_target_s),
        max_gap_s_(options.max_frame_gap_s),
        busy_until_(busy_until) {}

  /// After a pause the time that the rig has been near `open` begins again.
  bool arrives(const GuideFrame& frame, std::optional<OpenSuggestion>& open, Decision& d);
  /// Of a frame that arrived: whether it `shows` the target.
  bool hasTarget(bool shows, Decision& d);
  /// Of the frames before the last one [s]; longer than max_frame_gap_s: a jump.
  bool isAfterPause() const { return pause_s_ > max_gap_s_; }

  /// Busy from a frame's stamp on: decisions depend on the recording alone, not on the machine that
  /// replays it. More work adds to it.
  void work(TimeNs from, double s) { busy_until_ = from + toNanoseconds(s); }
  void workOn(double s) { busy_until_ += toNanoseconds(s); }
  TimeNs busyUntil() const { return busy_until_; }

 private:
  double lost_target_s_, max_gap_s_;
  TimeNs busy_until_;
  std::optional<TimeNs> last_;         // frame, whatever it showed
  std::optional<TimeNs> last_target_;  // before it was seen: the first frame looked at
  double pause_s_ = 0;
  bool lost_said_ = false;
};

}  // namespace plumbline
