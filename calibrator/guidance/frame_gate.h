// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <optional>

#include "calibrator/base/guide_decision.h"
#include "calibrator/guidance/guide_options.h"
#include "calibrator/guidance/open_suggestion.h"

namespace plumbline {

/// Why a first frame leaves the estimate (FrameGate::replacesFirst()).
constexpr const char* kWrongFirstStamp = "its stamp is far from those of the frames after it";

/// Which frames a stage of the guide looks at: those whose stamp is after all before, that come
/// when it is not busy, and that show the target. A stamp more than ten times max_frame_gap_s, and
/// 5 s, after the one before holds its frame back; the next frame shows whether there was a pause
/// or the stamp was wrong, and only a pause counts. Two frames in order that are so far before or
/// after the only frame until then replace it, and time begins with them. What holds a frame back,
/// a pause before it, time that begins anew, and a target that is long out of view are said in the
/// decision.
class FrameGate {
 public:
  /// `last`: stamp of the frame before the first that will arrive.
  explicit FrameGate(const GuideOptions& options,
                     TimeNs busy_until = std::numeric_limits<TimeNs>::min(),
                     std::optional<TimeNs> last = std::nullopt);

  /// After a pause the time that the rig has been near `open` begins again.
  bool arrives(const GuideFrame& frame, std::optional<OpenSuggestion>& open, Decision& d);
  /// Of a frame that arrived: the only one before it had a wrong stamp, and is to be left out.
  bool replacesFirst() const { return replaces_first_; }
  /// Stamp of the first frame that arrived, or of the one that replaced it; empty before.
  std::optional<TimeNs> since() const { return since_; }
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
  bool isInOrder(TimeNs t, TimeNs before, Decision& d);
  void startAnew(TimeNs t, std::optional<OpenSuggestion>& open);

  double lost_target_s_, max_gap_s_, far_s_;
  TimeNs busy_until_;
  std::optional<TimeNs> since_;       // when time begins
  std::optional<TimeNs> last_;        // frame, whatever it showed
  std::optional<TimeNs> doubted_;     // stamp of the frame just before, held back as too far off
  std::optional<TimeNs> lost_since_;  // empty: the last frame looked at showed the target
  double pause_s_ = 0;
  bool is_only_ = false;  // of all frames, only the last one has arrived
  bool replaces_first_ = false;
  bool lost_said_ = false;
};

}  // namespace plumbline
