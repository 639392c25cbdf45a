// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "evaluate/metrics/verdict.h"
#include "report/records/comparison_record.h"

namespace plumbline {

/// A parameter in which one of three and more calibrations stands alone: it differs from each of
/// the others by more than `significance` standard deviations, and these agree with each other
/// within `notable` ones.
struct LoneParameter {
  std::size_t calibration = 0;
  std::string name;
  double sigmas = 0;  ///< the smallest of its differences from the others
  double others = 0;  ///< the largest among the others
};

/// By calibration, the clearest first. Only parameters that three or more calibrations state with
/// a standard deviation, all comparable with the first's; differences are as if the estimates were
/// independent, those between two that are not the first to first order in their tangents.
std::vector<LoneParameter> loneParameters(const ComparisonRecord& record);

/// The same against the session's own estimate, for two calibrations and more: one stands alone
/// where the session and all others agree. Only where these others are known not to have been
/// estimated from that session: those that were agree with it anyway.
std::vector<LoneParameter> loneAgainstSession(const ComparisonRecord& record);

/// "T_SC0.tx (5.1), T_SC0.ry (4)": the clearest of one calibration's, with their deviations.
std::string loneNames(const std::vector<LoneParameter>& lone, std::size_t calibration);

/// A finding for each calibration that stands alone in some parameter.
std::vector<Finding> loneFindings(const ComparisonRecord& record);

}  // namespace plumbline
