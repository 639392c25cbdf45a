// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "evaluate/workflow/evaluate_trajectory.h"

namespace plumbline {

/// The JSON document of `evaluate trajectory`: n, association, alignment, scale, R (rows), t with
/// p_truth = scale R p_estimate + t; ate.translation_m, ate.rotation_deg and rpe[] with rmse, mean,
/// median, std, min, max, sse, n and percentiles; what was odd about the stamps; remarks.
std::string trajectoryDocument(const TrajectoryEvaluation& evaluation);

}  // namespace plumbline
