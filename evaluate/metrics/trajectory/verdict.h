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

/// What runs say: whether each calibration's are complete (`bad` where one failed, `caution` where
/// one is partial), what is left to be cured by an option (quaternions that are probably inverted),
/// and covariances that are too small. An error has no level: what it may be depends on the use.
///
/// The headline says how far estimates and truth are apart: of one run the ATE and what it stands
/// on; of several each calibration's median, and which is better where the 95 % interval of the
/// paired difference excludes zero. Then the gravest finding.
Verdict trajectoryVerdict(const TrajectoryStudy& study);

}  // namespace plumbline
