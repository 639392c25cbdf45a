// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "report/html/section.h"
#include "report/records/calibration_record.h"

namespace plumbline::html_internal {

/// How evenly the samples of every sensor follow each other: figures, a plot over time, and the
/// longest gaps by name.
Section intervalsSection(const CalibrationRecord& record);

}  // namespace plumbline::html_internal
