// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/replay_record.h"

namespace plumbline {

/// Writes decisions.jsonl, replay.json, records.sqlite and, if asked, report.html into `out`, all
/// together or not at all; see writeResultFolder().
void writeReplay(const ReplayRecord& record, const std::string& out, bool report);

}  // namespace plumbline
