// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>

#include <nlohmann/json.hpp>

#include "report/html/replay/sections.h"

namespace plumbline::html_internal {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostPath = 160;  // points of a trajectory's path

/// Position [mm] and quaternion x y z w [1/32767].
using RoundPose = std::array<std::int16_t, 7>;

RoundPose roundPose(const Transform& T) {
  Eigen::Vector4d q = T.quaternion().coeffs();
  // q and -q are one rotation: equal poses get equal cells, and are kept once.
  if (q[3] < 0) q = -q;
  RoundPose pose{};
  for (int i = 0; i < 3; ++i) pose[static_cast<std::size_t>(i)] = shortCell(1e3 * T.t[i]);
  for (int i = 0; i < 4; ++i) pose[static_cast<std::size_t>(3 + i)] = shortCell(32767 * q[i]);
  return pose;
}

/// Values in the order of their first use, each once: rounds score the same candidates again and
/// again.
template <class T>
struct OnceEach {
  std::map<T, std::uint32_t> places;
  std::vector<T> values;
  std::uint32_t place(const T& value) {
    const auto [at, is_new] = places.try_emplace(value, static_cast<std::uint32_t>(values.size()));
    if (is_new) values.push_back(value);
    return at->second;
  }
};

struct RoundValues {
  OnceEach<std::string> names;
  OnceEach<RoundPose> poses;
};

/// Predicted error after the frame on whose estimate a round's scores are based [px].
std::optional<double> errorBefore(const ReplayRecord& record, const Decision& d) {
  const auto found = std::ranges::find_if(record.decisions, [&](const Decision& asked) {
    return asked.t == d.round->asked && asked.stage == d.stage;
  });
  return found == record.decisions.end() ? std::nullopt : found->error_px;
}

Json numberOrNull(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json roundJson(const ReplayRecord& record, const Decision& d, RoundValues& tables) {
  const CandidateRound& round = *d.round;
  std::vector<std::uint32_t> names, poses;
  for (const std::string& name : round.names) names.push_back(tables.names.place(name));
  for (const Transform& T : round.T_FC0) poses.push_back(tables.poses.place(roundPose(T)));
  // NaN stays NaN, which JSON has no number for.
  const std::vector<float> mi(round.mi_nats.begin(), round.mi_nats.end());
  const std::vector<float> error(round.error_px.begin(), round.error_px.end());
  return {{"frame", d.frame},
          {"best", round.best},
          {"waited_s", secondsBetween(round.asked, round.answered)},
          {"threshold", d.threshold_nats},
          {"names", base64(names)},
          {"poses", base64(poses)},
          {"mi", base64(mi)},
          {"error", base64(error)},
          {"error_before", numberOrNull(errorBefore(record, d))}};
}

/// Between which frames a suggestion was open.
struct Band {
  int from = -1, to = -1;
};

/// The last frame that is not after `t`; the first where all are.
int frameAt(const ReplayRecord& record, TimeNs t) {
  int best = 0;
  for (std::size_t i = 0; i < record.frames.size(); ++i) {
    if (record.frames[i].t <= t) best = static_cast<int>(i);
  }
  return best;
}

/// From the frame that opened a suggestion to the last that names it.
std::map<int, Band> bandsOf(const ReplayRecord& record) {
  std::map<int, Band> bands;
  for (const Decision& d : record.decisions) {
    // The last decision that names a suggestion closes its band: it is open up to there.
    if (d.suggestion && bands.count(*d.suggestion) > 0) bands[*d.suggestion].to = d.frame;
    if (d.opened) bands[d.opened->id] = {d.frame, d.frame};
  }
  return bands;
}

/// Those of the record, then those that only a decision names.
std::vector<SuggestionOutcome> allOutcomes(const ReplayRecord& record) {
  std::vector<SuggestionOutcome> all = record.suggestions;
  for (const Decision& d : record.decisions) {
    const auto known = [&](const SuggestionOutcome& o) { return o.suggestion.id == d.opened->id; };
    if (!d.opened || std::ranges::any_of(all, known)) continue;
    all.emplace_back().suggestion = *d.opened;
  }
  return all;
}

/// Row by row of [R t]: R to 1e-6, t to a hundredth of a millimetre.
Json poseJson(const Transform& T) {
  Json cells = Json::array();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) cells.push_back(std::round(1e6 * T.R(i, j)) / 1e6);
    cells.push_back(std::round(1e5 * T.t[i]) / 1e5);
  }
  return cells;
}

/// Every n-th position [m], rounded to a tenth of a millimetre.
Json pathJson(const std::vector<Transform>& path) {
  Json points = Json::array();
  const std::size_t stride = std::max<std::size_t>(1, (path.size() + kMostPath - 1) / kMostPath);
  for (std::size_t i = 0; i < path.size(); i += stride) {
    for (const double x : path[i].t) points.push_back(std::round(1e4 * x) / 1e4);
  }
  return points;
}

Json overlayJson(const std::vector<std::vector<Corner>>& overlay) {
  Json cameras = Json::array();
  for (const std::vector<Corner>& corners : overlay) {
    std::vector<std::uint16_t> ids;
    // A target has 4 * 587 corners at most.
    for (const Corner& c : corners) ids.push_back(static_cast<std::uint16_t>(c.id));
    cameras.push_back({{"ids", base64(ids)}, {"uv", base64(quarterPixels(corners))}});
  }
  return cameras;
}

Json suggestionJson(const SuggestionOutcome& o, const Band& band) {
  const Suggestion& s = o.suggestion;
  return {{"id", s.id},
          {"stage", toString(s.stage)},
          {"from", band.from},
          {"to", band.to},
          {"end", toString(o.end)},
          {"name", s.candidate},
          {"camera", s.camera},
          {"pose", poseJson(s.T_FC0)},
          {"path", pathJson(s.path)},
          {"closest_px", numberOrNull(o.closest_px)},
          {"overlay", overlayJson(o.overlay)}};
}

}  // namespace

Json roundsJson(const ReplayRecord& record) {
  RoundValues tables;
  Json rounds = Json::array();
  for (const Decision& d : record.decisions) {
    if (d.round) rounds.push_back(roundJson(record, d, tables));
  }
  return {
      {"rounds", rounds}, {"names", tables.names.values}, {"poses", base64(tables.poses.values)}};
}

Json suggestionsJson(const ReplayRecord& record) {
  const std::map<int, Band> bands = bandsOf(record);
  Json suggestions = Json::array();
  for (const SuggestionOutcome& o : allOutcomes(record)) {
    const auto known = bands.find(o.suggestion.id);
    Band band;
    if (known != bands.end()) {
      band = known->second;
    } else {
      // Of a suggestion that no decision opened only the times are known; 0: no end is.
      const int last = std::max(0, static_cast<int>(record.frames.size()) - 1);
      band = {frameAt(record, o.suggestion.t), o.ended == 0 ? last : frameAt(record, o.ended)};
    }
    suggestions.push_back(suggestionJson(o, band));
  }
  return suggestions;
}

}  // namespace plumbline::html_internal
