// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/trajectory_record.h"

namespace plumbline {

/// Writes trajectory.json, trajectory.csv and records.sqlite into `out`, together or not at all;
/// see writeResultFolder().
void writeRuns(const TrajectoryRecord& record, const std::string& out);

}  // namespace plumbline
