// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "calibrator/base/guide_decision.h"
#include "calibrator/fields/fields.h"

namespace plumbline {

// Field lists (see fields.h) of the guide's decisions. Documents have gains in bits beside nats.

inline double inBits(double nats) { return nats / std::numbers::ln2; }
inline std::optional<double> inBits(const std::optional<double>& nats) {
  return nats ? std::optional(inBits(*nats)) : std::nullopt;
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
  v("duration_s", s.duration_s, "s", "of a trajectory, from its start to its end");
  v("mi_nats", s.mi_nats, "nat", "expected information gain; 0: not scored");
  v.derived("mi_bits", inBits(s.mi_nats), "bit", "the same in bits");
  bool unbounded = std::isinf(s.mi_nats);
  v.ifSet("mi_unbounded", unbounded, "the views before do not determine all parameters");
  if (V::kReads && unbounded) s.mi_nats = std::numeric_limits<double>::infinity();
  v("error_px", s.error_px, "px", "predicted error in later use with it");
  v("reach_s", s.reach_s, "s", "predicted time until it is reached");
}

void fields(auto& v, CandidateRound& r) {
  v("asked_ns", r.asked, "stamp of the frame whose estimate the scores are based on");
  v("answered_ns", r.answered, "recording's time at which the scores were available");
  v("candidates", r.names, "their names");
  v("T_FC0", r.T_FC0, "of the view, or of the trajectory's start");
  v("mi_nats", r.mi_nats, "gain of each; null: it could not be scored");
  std::vector<double> mi_bits;
  for (const double nats : r.mi_nats) mi_bits.push_back(inBits(nats));
  v.derived("mi_bits", mi_bits, "", "the same in bits");
  v("error_px", r.error_px, "predicted error in later use with each [px]");
  v.ifSet("reach_s", r.reach_s, "predicted time until each is reached [s], where it counts");
  v("best", r.best, "the best by the criterion; -1: none could be scored");
}

void fields(auto& v, Decision& d) {
  v("t_ns", d.t, "the frame's stamp (camera 0's clock)");
  v("frame", d.frame, "its position in the recording");
  v("stage", d.stage, "`camera` or `camera-imu`");
  v("mode", d.mode, "after the frame");
  v("reason", d.reason, "why the frame was treated as it was");
  v("accepted", d.accepted, "the frame entered the estimate");
  v("withdrawn", d.withdrawn,
    "frames accepted before that were removed from the estimate with this one");
  v("mi_nats", d.mi_nats, "nat", "its gain; null: it has none, or `mi_unbounded`");
  v.derived("mi_bits", inBits(d.mi_nats), "bit", "the same in bits");
  v.derived("mi_unbounded", d.mi_nats && std::isinf(*d.mi_nats), "",
            "the views before do not determine all parameters");
  v("entropy_nats", d.entropy_nats, "nat", "of the calibration parameters, after the frame");
  v.derived("entropy_bits", inBits(d.entropy_nats), "bit", "the same in bits");
  v("threshold_nats", d.threshold_nats, "nat", "what the gain was compared with");
  // As it was asked for: without the last digits that the change of unit disturbs.
  v.derived("threshold_bits", std::round(1e12 * inBits(d.threshold_nats)) / 1e12, "bit",
            "the same in bits");
  v("error_px", d.error_px, "px", "predicted error in later use of the views kept");
  v("error_with_px", d.error_with_px, "px", "the same with this frame");
  v("error_bound_px", d.error_bound_px, "px",
    "what `error_with_px` was compared with, in the camera-IMU stage `error_px`; null where the "
    "gain decides");
  v("excess", d.excess, "1", "relative increase of a corner's error that it causes");
  v("projection_px", d.projection_px, "px",
    "predicted RMS projection error, with `--stop-projection-px`");
  v("corners", d.corners, "seen by all cameras");
  v("views_kept", d.views_kept, "accepted in this stage so far");
  v("frames_without_view", d.frames_without_view, "offered since the last accepted one");
  v("rmse_px", d.rmse_px, "px", "of the window, after the frame");
  v("T_FC0", d.T_FC0, "m", "pose of camera 0");
  v("event", d.event, "what happened to the suggestion");
  v.derived("reached", d.event == SuggestionEvent::kReached, "", "the event is `reached`");
  v("suggestion", d.suggestion, "id of the one that is open, or was closed here");
  v("distance_px", d.distance_px, "px", "mean corner distance to it");
  v("open_s", d.open_s, "s", "since it was shown; with `reached` the time that it took");
  v("held_s", d.held_s, "s", "time for which the distance has been small enough");
  v("opened", d.opened, "with the event `opened`");
  v("round", d.round, "scores that arrived with this frame");
  v("detail", d.detail, "what could not be done and why");
}

}  // namespace plumbline
