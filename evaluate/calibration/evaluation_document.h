// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/calibration_record.h"

namespace plumbline {

/// evaluation.json: scores[] with label, session, part, held_out, reprojection errors of all
/// corners and of each camera, those under the IMU, entropy with its parameters, and what prevented
/// a score; then assumptions and provenance. Figures that there are not are absent.
std::string evaluationDocument(const CalibrationRecord& record);

/// The same for a person: one line a score.
std::string evaluationSummary(const CalibrationRecord& record);

}  // namespace plumbline
