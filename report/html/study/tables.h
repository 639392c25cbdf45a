// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "report/html/section.h"
#include "report/records/study_record.h"

namespace plumbline::html_internal {

// The tables of a study's page.

Section methodsSection(const StudyRecord& record);
Section failuresSection(const StudyRecord& record);
Section sessionsSection(const StudyRecord& record);

}  // namespace plumbline::html_internal
