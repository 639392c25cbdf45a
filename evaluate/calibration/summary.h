// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/calibration_record.h"

namespace plumbline {

/// The same for a person: one line a score.
std::string evaluationSummary(const CalibrationRecord& record);

}  // namespace plumbline
