// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "calibrator/base/fields.h"
#include "calibrator/base/guide_decision.h"

namespace plumbline {

// Words and field lists (see fields.h) of the guide's decisions.

constexpr std::array<const char*, 2> enumWords(GuideStage /*of*/) {
  return {"camera", "camera-imu"};
}

constexpr std::array<const char*, 4> enumWords(GuideMode /*of*/) {
  return {"initialising", "collecting", "suggesting", "finished"};
}

constexpr std::array<const char*, 14> enumWords(GuideReason /*of*/) {
  return {"initialising", "initialised", "initialise-failed", "informative", "not-informative",
          "used",         "busy",        "no-target",         "no-pose",     "time-jump",
          "no-imu",       "imu-gap",     "not-solved",        "finished"};
}

constexpr std::array<const char*, 5> enumWords(SuggestionEvent /*of*/) {
  return {"none", "opened", "reached", "expired", "withdrawn"};
}

template <class V>
void fields(V& v, Suggestion& s) {
  v("id", s.id, "counts from 0 over both stages");
  v("stage", s.stage, "`camera` or `camera-imu`");
  v("t_ns", s.t, "when it was shown");
  v("candidate", s.candidate, "`cam0 x -0.50 y +0.25 tilt-x 30` or `figure 8 horizontal`");
  v("camera", s.camera, "for whose image the view was made; 0 for a trajectory");
  v("T_FC0", s.T_FC0, "m", "the view; for a trajectory, its start");
  v.array("path", s.path, "T_FC0 along a trajectory; empty for a view");
  v("mi_nats", s.mi_nats, "nat", "expected information gain");
  bool unbounded = std::isinf(s.mi_nats);
  v.ifSet("mi_unbounded", unbounded, "the views before left parameters free");
  if (V::kReads && unbounded) s.mi_nats = std::numeric_limits<double>::infinity();
}

template <class V>
void fields(V& v, CandidateRound& r) {
  v("asked_ns", r.asked, "stamp of the frame whose estimate the scores stand on");
  v("answered_ns", r.answered, "recording's time at which the answer was there");
  v("candidates", r.names, "their names");
  v("T_FC0", r.T_FC0, "of the view, or of the trajectory's start");
  v("mi_nats", r.mi_nats, "gain of each; null: it could not be scored");
  v("best", r.best, "highest gain; -1: none could be scored");
}

template <class V>
void fields(V& v, Decision& d) {
  v("t_ns", d.t, "the frame's stamp (camera 0's clock)");
  v("frame", d.frame, "its position in the recording");
  v("stage", d.stage, "`camera` or `camera-imu`");
  v("mode", d.mode, "after the frame");
  v("reason", d.reason, "why the frame was treated as it was");
  v("accepted", d.accepted, "the frame entered the estimate");
  v("withdrawn", d.withdrawn, "frames accepted before that left the estimate with this one");
  v("mi_nats", d.mi_nats, "nat", "its gain");
  v("entropy_nats", d.entropy_nats, "nat", "of the calibration parameters, after the frame");
  v("threshold_nats", d.threshold_nats, "nat", "what the gain was compared with");
  v("corners", d.corners, "seen by all cameras");
  v("views_kept", d.views_kept, "accepted in this stage so far");
  v("frames_without_view", d.frames_without_view, "offered since the last accepted one");
  v("rmse_px", d.rmse_px, "px", "of the window, after the frame");
  v("T_FC0", d.T_FC0, "m", "where the camera was");
  v("event", d.event, "what happened to the suggestion");
  v("suggestion", d.suggestion, "id of the one that is open, or was closed here");
  v("distance_px", d.distance_px, "px", "mean corner distance to it");
  v("held_s", d.held_s, "s", "how long the distance has been small enough");
  v("opened", d.opened, "with the event `opened`");
  v("round", d.round, "scores that arrived with this frame");
  v("detail", d.detail, "what could not be done and why");
}

}  // namespace plumbline
