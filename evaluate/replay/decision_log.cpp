// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/decision_log.h"

#include <cmath>
#include <optional>

#include "calibrator/base/json_fields.h"
#include "calibrator/information/covariance.h"

namespace plumbline {
namespace {

Json bits(const std::optional<double>& nats) { return nats ? toJson(bitsFromNats(*nats)) : Json(); }

/// The threshold as it was asked for: without the last digits that the change of unit disturbs.
double thresholdBits(double nats) { return std::round(1e12 * bitsFromNats(nats)) / 1e12; }

/// Position, then the Hamilton quaternion x y z w.
Json poseJson(const Transform& T) {
  const Eigen::Quaterniond q = T.quaternion();
  return {T.t.x(), T.t.y(), T.t.z(), q.x(), q.y(), q.z(), q.w()};
}

Json suggestionJson(const Suggestion& s) {
  return {{"id", s.id},
          {"t_ns", s.t},
          {"candidate", s.candidate},
          {"camera", s.camera},
          {"mi_bits", toJson(bitsFromNats(s.mi_nats))},
          {"mi_nats", toJson(s.mi_nats)},
          {"T_FC0", poseJson(s.T_FC0)}};
}

Json roundJson(const CandidateRound& round) {
  Json scores = Json::array();
  for (const double nats : round.mi_nats) scores.push_back(toJson(bitsFromNats(nats)));
  return {{"asked_ns", round.asked},
          {"answered_ns", round.answered},
          {"best", round.best},
          {"candidates", round.names},
          {"mi_bits", scores}};
}

}  // namespace

std::string decisionLine(const Decision& d) {
  Json line{{"t_ns", d.t},
            {"stage", toString(d.stage)},
            {"mode", toString(d.mode)},
            {"frame", d.frame},
            {"accepted", d.accepted},
            {"withdrawn", d.withdrawn},
            {"mi_bits", bits(d.mi_nats)},
            {"mi_nats", toJson(d.mi_nats)},
            {"mi_unbounded", d.mi_nats.has_value() && std::isinf(*d.mi_nats)},
            {"threshold_bits", thresholdBits(d.threshold_nats)},
            {"entropy_nats", toJson(d.entropy_nats)},
            {"entropy_bits", bits(d.entropy_nats)},
            {"suggestion", toJson(d.suggestion)},
            {"event", toString(d.event)},
            {"reached", d.event == SuggestionEvent::kReached},
            {"distance_px", toJson(d.distance_px)},
            {"held_s", d.held_s},
            {"corners", d.corners},
            {"views_kept", d.views_kept},
            {"frames_without_view", d.frames_without_view},
            {"rmse_px", toJson(d.rmse_px)},
            {"reason", toString(d.reason)},
            {"detail", d.detail}};
  if (d.opened) line["opened"] = suggestionJson(*d.opened);
  if (d.round) line["round"] = roundJson(*d.round);
  return line.dump() + "\n";
}

std::string decisionLog(const std::vector<Decision>& decisions) {
  std::string text;
  for (const Decision& decision : decisions) text += decisionLine(decision);
  return text;
}

}  // namespace plumbline
