// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/replay_record.h"

namespace plumbline {

/// The same for a terminal, in short.
std::string replaySummary(const ReplayRecord& record);

}  // namespace plumbline
