// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/trajectory_record.h"

namespace plumbline {

/// What `evaluate trajectory` prints for a person: a table of errors, rmse first, the pairs and the
/// alignment they stand on, and the remarks.
std::string trajectorySummary(const TrajectoryRun& run);

/// What `evaluate trajectories` prints for a person: completion and median ATE by sequence and
/// calibration, paired differences, and why each run that is not complete is so.
std::string runsSummary(const TrajectoryStudy& study);

/// trajectory.csv: one row for each run.
std::string runsTable(const TrajectoryRecord& record);

}  // namespace plumbline
