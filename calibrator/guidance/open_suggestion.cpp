// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/open_suggestion.h"

#include <utility>

#include "calibrator/guidance/frame_corners.h"

namespace plumbline {

OpenSuggestion::OpenSuggestion(Suggestion suggestion, std::vector<Corner> corners,
                               const ReachRule& rule)
    : suggestion_(std::move(suggestion)), corners_(std::move(corners)), rule_(rule) {}

OpenSuggestion::Progress OpenSuggestion::update(TimeNs t, const std::vector<Corner>& seen) {
  Progress now;
  now.distance_px = meanCornerDistance(corners_, seen);
  if (!now.distance_px || *now.distance_px > rule_.reached_px) {
    // A single frame off, or without the target, begins the hold anew.
    near_since_.reset();
  } else if (!near_since_) {
    near_since_ = t;
  }
  if (near_since_) now.held_s = secondsBetween(*near_since_, t);
  // Reached wins over expired: who holds the view when time is up has followed it.
  if (near_since_ && now.held_s >= rule_.reached_s) {
    now.event = SuggestionEvent::kReached;
  } else if (secondsBetween(suggestion_.t, t) > rule_.expires_s) {
    now.event = SuggestionEvent::kExpired;
  }
  return now;
}

void OpenSuggestion::restart(TimeNs t) {
  suggestion_.t = t;
  near_since_.reset();
}

}  // namespace plumbline
