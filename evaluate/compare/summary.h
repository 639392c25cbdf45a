// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/comparison_record.h"

namespace plumbline {

/// comparison.csv: one row per parameter, and per sequence of the trajectories their median ATE;
/// value, std, difference and significance of each calibration in columns, empty where unknown.
/// The difference of ATEs is the mean over pairs of runs, in the row of all sequences
/// ("ate.all", or the only one).
std::string comparisonTable(const ComparisonRecord& record);

/// What a person reads on the terminal: parameters side by side, scores, maps in brief, verdict.
std::string comparisonSummary(const ComparisonRecord& record);

}  // namespace plumbline
