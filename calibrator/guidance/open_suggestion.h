// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "calibrator/base/guide_decision.h"
#include "calibrator/base/session.h"
#include "calibrator/guidance/guide_options.h"

namespace plumbline {

/// A suggestion that waits for the operator.
class OpenSuggestion {
 public:
  /// `corners`: what the suggestion's camera would see there.
  OpenSuggestion(Suggestion suggestion, std::vector<Corner> corners, const ReachRule& rule);

  struct Progress {
    SuggestionEvent event = SuggestionEvent::kNone;  ///< none, reached, expired
    std::optional<double> distance_px;
    double held_s = 0;
  };
  /// With every frame: what the suggestion's camera saw (empty: nothing).
  Progress update(TimeNs t, const std::vector<Corner>& seen);

  /// Drawn anew, by cameras that are better known.
  void redraw(std::vector<Corner> corners) { corners_ = std::move(corners); }
  /// It is taken to have been shown at `t`.
  void restart(TimeNs t);

  const Suggestion& suggestion() const { return suggestion_; }

 private:
  Suggestion suggestion_;
  std::vector<Corner> corners_;
  ReachRule rule_;
  std::optional<TimeNs> near_since_;
};

}  // namespace plumbline
