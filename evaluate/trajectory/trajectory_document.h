// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "evaluate/trajectory/evaluate_trajectory.h"

namespace plumbline {

/// The JSON document of `evaluate trajectory`: n, association, alignment, scale, R (rows), t with
/// p_truth = scale R p_estimate + t; ate.translation_m, ate.rotation_deg and rpe[] with rmse, mean,
/// median, std, min, max, sse, n and percentiles; what was odd about the stamps; remarks;
/// clock_offset, hand_eye (4x4 rows, 6x6 covariance of (dt, da)) and nees where they are known.
std::string trajectoryDocument(const TrajectoryEvaluation& evaluation);

/// The same of a run, as JSON; of a failed one only files and remarks.
nlohmann::ordered_json trajectoryRunJson(const TrajectoryRun& run);

}  // namespace plumbline
