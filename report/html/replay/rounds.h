// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "report/records/replay_record.h"

namespace plumbline::html_internal {

/// The rounds of candidates, with tables of their names and poses beside them: a session asks the
/// same candidates again and again.
nlohmann::ordered_json roundsJson(const ReplayRecord& record);

/// Suggestions with how they ended, as bands between frames; those that no outcome names are taken
/// from the decisions.
nlohmann::ordered_json suggestionsJson(const ReplayRecord& record);

}  // namespace plumbline::html_internal
