// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "evaluate/trajectory/evaluate_trajectory.h"

namespace plumbline {

/// What `evaluate trajectory` prints for a person: a table of errors, rmse first, the pairs and the
/// alignment they stand on, and the remarks.
std::string trajectorySummary(const TrajectoryEvaluation& evaluation);

}  // namespace plumbline
