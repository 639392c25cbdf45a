// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/calibration_record.h"

namespace plumbline {

/// What a person wants to see on the terminal after a calibration: the parameters with their
/// standard deviations, the errors, and the verdict with every finding that is not good.
std::string calibrationSummary(const CalibrationRecord& record);

}  // namespace plumbline
