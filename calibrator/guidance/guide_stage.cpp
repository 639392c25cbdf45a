// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/guide_stage.h"

#include <utility>

namespace plumbline {

Decision decisionOn(const GuideFrame& frame, GuideStage stage, double threshold_nats) {
  Decision d;
  d.t = frame.t;
  d.frame = frame.index;
  d.stage = stage;
  d.threshold_nats = threshold_nats;
  for (const std::vector<Corner>& view : frame.corners) d.corners += static_cast<int>(view.size());
  return d;
}

void StageState::show(Suggestion s, std::vector<Corner> corners, const ReachRule& rule,
                      Decision& d) {
  has_asked = true;
  s.id = next_suggestion++;
  s.stage = d.stage;
  open.emplace(s, std::move(corners), rule);
  d.event = SuggestionEvent::kOpened;
  d.suggestion = s.id;
  d.opened = std::move(s);
}

void StageState::follow(const GuideFrame& frame, Decision& d) {
  if (!open) return;
  const auto camera = static_cast<std::size_t>(open->suggestion().camera);
  const OpenSuggestion::Progress progress = open->update(frame.t, frame.corners[camera]);
  d.event = progress.event;
  d.suggestion = open->suggestion().id;
  d.distance_px = progress.distance_px;
  d.open_s = secondsBetween(open->suggestion().t, frame.t);
  d.held_s = progress.held_s;
  if (progress.event != SuggestionEvent::kNone) open.reset();
}

void StageState::withdrawOpen(Decision& d) {
  if (!open) return;
  d.event = SuggestionEvent::kWithdrawn;
  d.suggestion = open->suggestion().id;
  open.reset();
}

void StageState::finish(double batch_s, Decision& d) {
  finished = true;
  gate.workOn(batch_s);
  withdrawOpen(d);
}

void StageState::tell(bool started, std::size_t kept, Decision& d) const {
  d.mode = finished   ? GuideMode::kFinished
           : !started ? GuideMode::kInitialising
           : open     ? GuideMode::kSuggesting
                      : GuideMode::kCollecting;
  d.views_kept = static_cast<int>(kept);
  d.frames_without_view = frames_without_view;
}

}  // namespace plumbline
