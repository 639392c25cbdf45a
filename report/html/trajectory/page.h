// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/trajectory_record.h"

namespace plumbline {

/// One self-contained HTML page of trajectories against their truth: completion per calibration
/// with failures counted, absolute errors per sequence and calibration, paired differences,
/// overlays coloured by error, errors over time, relative errors by distance, clock offsets,
/// hand-eye, NEES, and how stamps were paired. What no run has is left out. Equal records give
/// equal bytes. One thread at a time (see report/plots/svg.h).
std::string renderTrajectoryPage(const TrajectoryRecord& record);

}  // namespace plumbline
