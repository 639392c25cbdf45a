// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace plumbline {

/// The JSON document that a command writes and the store keeps: the fields of a record as its
/// header lists them, two spaces a level. docs/records.md has their tables. For CalibrationRecord,
/// ComparisonRecord, PerturbationRecord, ReplayRecord, StudyRecord (summary.json), TrajectoryRecord
/// and SingleTrajectory (`evaluate trajectory --json`).
template <class Record>
std::string documentOf(const Record& record);

}  // namespace plumbline
