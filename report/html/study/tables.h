// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "report/html/section.h"
#include "report/records/study_record.h"

namespace plumbline::html_internal {

// The tables of sessions, tools and nights of a study's page.

Section othersSection(const StudyRecord& record);
Section nightsSection(const StudyRecord& record);
/// Sessions without a calibration, whose participant gave up, or with a bad verdict, and why.
Section failuresSection(const StudyRecord& record);
Section sessionsSection(const StudyRecord& record);

/// A number in a cell, or a dash.
Cell orDash(const std::optional<double>& value, double factor, const char* format);
/// A session's name, leading to its page.
Cell linkTo(const StudySession& session);
/// Of that name; null if there is none.
const StudySession* sessionOf(const StudyRecord& record, const std::string& name);

}  // namespace plumbline::html_internal
