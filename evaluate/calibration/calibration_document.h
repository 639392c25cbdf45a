// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/calibration_record.h"

namespace plumbline {

/// calibration.json of a record (docs/calibration_json.md has every field): stages, cameras, IMU,
/// covariances with their parameter lists, assumptions, verdict, provenance. Numbers read back to
/// the same doubles; fields of stages that did not run are absent.
std::string calibrationDocument(const CalibrationRecord& record);

/// residuals.csv: one row for each corner of both stages.
std::string residualsTable(const CalibrationRecord& record);

}  // namespace plumbline
