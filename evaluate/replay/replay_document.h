// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/replay_record.h"

namespace plumbline {

/// replay.json: stages, suggestions, stop audits, compliance, counterfactuals, assumptions, verdict
/// and provenance; what each frame led to is in decisions.jsonl. Fields in docs/replay.md.
std::string replayDocument(const ReplayRecord& record);

/// The same for a terminal, in short.
std::string replaySummary(const ReplayRecord& record);

}  // namespace plumbline
