// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "report/html/section.h"
#include "report/records/study_record.h"

namespace plumbline::html_internal {

// The sections of a study's page that are figures. A point leads to its session's page.

/// Median time per participant by stage, and who was done when.
Section timeSection(const StudyRecord& record);
/// ATE by sequence and method, boxes over calibrations.
Section trajectorySection(const StudyRecord& record);
/// Every calibration on the recordings that no method saw.
Section heldOutSection(const StudyRecord& record);
Section entropySection(const StudyRecord& record);
/// Time offsets with their deviations, mean and spread by method.
Section offsetSection(const StudyRecord& record);
/// Spread over sessions against the stated deviations.
Section spreadSection(const StudyRecord& record);
/// Terms of the board's shape over the sessions.
Section boardSection(const StudyRecord& record);

}  // namespace plumbline::html_internal
