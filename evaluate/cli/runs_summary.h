// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/trajectory_record.h"

namespace plumbline {

/// What `evaluate trajectories` prints for a person: completion and median ATE by sequence and
/// calibration, paired differences, and why each run that is not complete is so.
std::string runsSummary(const TrajectoryRecord& record);

}  // namespace plumbline
