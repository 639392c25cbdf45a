// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "report/records/replay_record.h"

namespace plumbline {

/// What a replay's figures say of the recording and of the guide, stage by stage: whether it could
/// start, whether it stopped and rightly so, how far its calibration is from that of all frames.
std::vector<Finding> replayFindings(const ReplayRecord& record);

}  // namespace plumbline
