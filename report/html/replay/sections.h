// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "calibrator/base/session.h"
#include "report/html/section.h"
#include "report/html/text.h"
#include "report/records/replay_record.h"

namespace plumbline::html_internal {

/// u and v of each corner in quarter pixels; what lies beyond 8191 px is put there.
inline std::vector<std::int16_t> quarterPixels(const std::vector<Corner>& corners) {
  std::vector<std::int16_t> values;
  values.reserve(2 * corners.size());
  for (const Corner& c : corners) {
    for (const double x : c.uv) values.push_back(shortCell(4 * x));
  }
  return values;
}

/// A line of the list beside the player.
struct ReplayEvent {
  int frame = 0;
  /// "initialised", "opened", "reached", "expired", "withdrawn", "finished", "problem".
  std::string kind;
  std::string text;
};

/// What happened, in the order of the decisions. A problem that lasts over frames in a row is one
/// event at its first, with their number.
std::vector<ReplayEvent> replayEvents(const ReplayRecord& record);

/// "1.234 bits (0.855 nats)"; "unbounded" where infinite.
std::string bitsAndNats(double nats);

/// The rounds of candidates, with tables of their names and poses beside them: a session asks the
/// same candidates again and again.
nlohmann::ordered_json roundsJson(const ReplayRecord& record);

/// Suggestions with how they ended, as bands between frames; those that no outcome names are taken
/// from the decisions.
nlohmann::ordered_json suggestionsJson(const ReplayRecord& record);

/// What the player's scripts read (report/html/player/replay_data.js is the other side).
struct ReplayData {
  std::string json;    ///< decisions, corners, rounds, suggestions, events; '<' escaped
  std::string images;  ///< base64 JPEGs, a line per image, cameras innermost
  int frames_with_images = 0;
  int image_step = 1;  ///< every so many-th of them is in the page
};

/// Corners in quarter pixels (int16), decisions as doubles, poses as floats, all in base64. Poses
/// of candidates are rounded to a millimetre and 1/32767, equal ones stand once. Images take up to
/// `image_bytes`, less where the rest leaves no more of `bytes` for both.
ReplayData replayData(const ReplayRecord& record, std::size_t image_bytes, std::size_t bytes);

/// Frames of the replay: those recorded, and any that a decision names beyond them.
std::size_t frameCount(const ReplayRecord& record);

/// Each stage in figures, and the batch over what was kept beside that over everything.
Section replayStagesSection(const ReplayRecord& record);
/// What the guide asked for and what became of it.
Section replaySuggestionsSection(const ReplayRecord& record);
/// Was "finish" right?
Section stopAuditSection(const ReplayRecord& record);
/// How the operator of a guided recording followed.
Section complianceSection(const ReplayRecord& record);
/// Other orders of the same frames: entropy and held-out error over the number of views.
Section counterfactualsSection(const ReplayRecord& record);

}  // namespace plumbline::html_internal
