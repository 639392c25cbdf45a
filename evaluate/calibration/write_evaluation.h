// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/calibration_record.h"

namespace plumbline {

/// evaluation.json, records.sqlite and report.html of a record whose `held` is set, into `out`.
void writeEvaluation(const CalibrationRecord& record, const std::string& out);

}  // namespace plumbline
