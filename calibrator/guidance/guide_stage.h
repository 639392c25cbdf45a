// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calibrator/guidance/frame_gate.h"
#include "calibrator/guidance/guide_options.h"
#include "calibrator/guidance/open_suggestion.h"

namespace plumbline {

/// Of a frame that nobody has looked at.
Decision decisionOn(const GuideFrame& frame, GuideStage stage, double threshold_nats = 0);

/// What both stages of the guide keep beside their estimates.
struct StageState {
  GuideRig rig;
  GuideOptions options;
  FrameGate gate;
  int next_suggestion = 0;
  int frames_without_view = 0;
  bool finished = false;
  bool has_asked = false;  // for anything yet
  std::optional<OpenSuggestion> open = {};

  /// Opens a suggestion whose id and stage are not written yet; `corners`: see OpenSuggestion.
  void show(Suggestion s, std::vector<Corner> corners, const ReachRule& rule, Decision& d);
  /// Predicted time from d.T_FC0 to a pose, and to hold it: both are the operator's [s].
  double secondsTo(const Transform& T_FC0, const ReachRule& rule, const Decision& d) const {
    return options.pace.secondsTo(*d.T_FC0, T_FC0) + rule.reached_s;
  }
  /// Progress towards the suggestion that is open, with every frame, target or not.
  void follow(const GuideFrame& frame, Decision& d);
  /// The suggestion that is open is taken back.
  void withdrawOpen(Decision& d);
  /// Nothing is left to ask for; what follows keeps the guide busy for `batch_s`.
  void finish(double batch_s, Decision& d);
  /// What holds after the frame; `started`: the estimate stands.
  void tell(bool started, std::size_t kept, Decision& d) const;
};

}  // namespace plumbline
