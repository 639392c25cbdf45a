// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/decision_log.h"

#include <cmath>
#include <optional>

#include <nlohmann/json.hpp>

#include "calibrator/information/covariance.h"
#include "evaluate/results/json_values.h"

namespace plumbline {
namespace {

using Json = nlohmann::ordered_json;

Json bits(const std::optional<double>& nats) {
  return nats ? finiteJson(bitsFromNats(*nats)) : Json();
}

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
          {"mi_bits", finiteJson(bitsFromNats(s.mi_nats))},
          {"mi_nats", finiteJson(s.mi_nats)},
          {"T_FC0", poseJson(s.T_FC0)}};
}

Json roundJson(const CandidateRound& round) {
  Json scores = Json::array();
  for (const double nats : round.mi_nats) scores.push_back(finiteJson(bitsFromNats(nats)));
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
            {"mi_nats", d.mi_nats ? finiteJson(*d.mi_nats) : Json()},
            {"mi_unbounded", d.mi_nats.has_value() && std::isinf(*d.mi_nats)},
            {"threshold_bits", thresholdBits(d.threshold_nats)},
            {"entropy_nats", d.entropy_nats ? finiteJson(*d.entropy_nats) : Json()},
            {"entropy_bits", bits(d.entropy_nats)},
            {"suggestion", optionalJson(d.suggestion)},
            {"event", toString(d.event)},
            {"reached", d.event == SuggestionEvent::kReached},
            {"distance_px", optionalJson(d.distance_px)},
            {"held_s", d.held_s},
            {"corners", d.corners},
            {"views_kept", d.views_kept},
            {"frames_without_view", d.frames_without_view},
            {"rmse_px", optionalJson(d.rmse_px)},
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
