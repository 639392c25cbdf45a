// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/comparison_record.h"

namespace plumbline {

/// One self-contained HTML page of two or more calibrations side by side: verdict with the findings
/// of the convention lint, every parameter with difference and significance, transforms, the time
/// offset in every tool's sign, scores on recordings, entropies with their parameters, maps of
/// projection difference and uncertainty, and the trajectories where there are any. What is missing
/// is a dash with its reason. Equal records give equal bytes. One thread at a time (see
/// report/plots/svg.h).
std::string renderComparisonPage(const ComparisonRecord& record);

}  // namespace plumbline
