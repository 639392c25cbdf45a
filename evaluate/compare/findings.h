// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "evaluate/compare/parameters.h"
#include "report/records/comparison_record.h"

namespace plumbline {

/// What a comparison says, in the order in which it is read: parameters that differ beyond their
/// deviations, transforms and offsets, the worst projection difference of each pair and camera with
/// its value at the centre, which calibration predicts corners better, calibrations that could not
/// be scored; then the lint of every calibration.
std::vector<Finding> comparisonFindings(const ComparisonRecord& record,
                                        const ComparisonThresholds& thresholds = {});

/// What a reader asks of a comparison first, for every calibration but the first: which predicts
/// corners better and by how much (pooled over cameras, 95 % interval of the paired difference;
/// only "better" where it excludes zero), and by how much they differ over the image, in T_SC0 and
/// in the time offset; then which of three and more stands alone, and in what (loneParameters()).
std::string comparisonHeadline(const ComparisonRecord& record,
                               const ComparisonThresholds& thresholds = {});

}  // namespace plumbline
