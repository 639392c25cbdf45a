// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/guide_decision.h"
#include "report/records/replay_record.h"

namespace plumbline {

/// One decision as one line of decisions.jsonl, with its line end: its fields (guide_fields.h),
/// null where there is no value. Suggestions and rounds of candidates appear on the line of the
/// frame that brought them.
std::string decisionLine(const Decision& decision);

/// All of them.
std::string decisionLog(const std::vector<Decision>& decisions);

/// The same for a terminal, in short.
std::string replaySummary(const ReplayRecord& record);

}  // namespace plumbline
