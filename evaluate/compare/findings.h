// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "report/records/comparison_record.h"

namespace plumbline {

/// When a difference is worth a person's attention.
struct ComparisonThresholds {
  double significance = 3;       ///< of a parameter's difference [standard deviations]
  double difference_px = 1;      ///< worst projection difference, caution above
  double difference_bad_px = 5;  ///< and bad above
  double prediction_sigmas = 3;  ///< of a paired prediction
};

/// What a comparison says, in the order in which it is read: parameters that differ beyond their
/// deviations, transforms and offsets, the worst projection difference of each pair and camera with
/// its value at the centre, which calibration predicts corners better, calibrations that could not
/// be scored; then the lint of every calibration.
std::vector<Finding> comparisonFindings(const ComparisonRecord& record,
                                        const ComparisonThresholds& thresholds = {});

}  // namespace plumbline
