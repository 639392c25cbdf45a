// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibrator/fields/json_fields.h"
#include "report/records/calibration_record.h"
#include "report/records/comparison_record.h"
#include "report/records/perturbation_record.h"
#include "report/records/replay_record.h"
#include "report/records/study_record.h"
#include "report/records/trajectory_record.h"

namespace plumbline::store_internal {

/// What the parts of a record that was read must agree on, and the sizes that pages are drawn from:
/// a file that was damaged or made up is refused here, rather than drawn for ever. Each throws
/// std::runtime_error.
void checkRecord(const CalibrationRecord& record);
void checkRecord(const PerturbationRecord& record);
void checkRecord(const ReplayRecord& record);
inline void checkRecord(const TrajectoryRecord& /*record*/) {}
inline void checkRecord(const ComparisonRecord& /*record*/) {}
inline void checkRecord(const StudyRecord& /*record*/) {}

/// JSON of a document. Throws std::runtime_error where it is larger, or nested deeper, than any
/// that this program writes, and nlohmann's exceptions for what is no JSON.
Json parsedDocument(const std::string& text);

}  // namespace plumbline::store_internal
