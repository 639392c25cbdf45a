// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "report/records/replay_record.h"

namespace plumbline::html_internal {

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

}  // namespace plumbline::html_internal
