// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "report/records/trajectory_record.h"

namespace plumbline {

/// Every two calibrations of the runs, in order of appearance. Runs that failed or are partial have
/// no comparable error; their pairs are counted as left out. Runs pair by sequence and run.
std::vector<PairedDifference> pairedDifferences(const std::vector<TrajectoryRun>& runs);

/// Exact two-sided p of `successes` out of n fair coin tosses; 1 for n = 0.
double signTest(std::size_t successes, std::size_t n);

/// By sequence, then, of several, all together; calibrations in the order of the runs.
std::vector<RunsSummary> summarised(const std::vector<TrajectoryRun>& runs);

/// The runs with both.
TrajectoryStudy studyOf(std::vector<TrajectoryRun> runs);

}  // namespace plumbline
