// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "report/html/section.h"
#include "report/records/study_record.h"

namespace plumbline::html_internal {

// What a study's statistics say: words and tables.

/// The sentences, each method's figures, effects by endpoint, tests of three methods or more.
Section resultsSection(const StudyRecord& record);
/// Effects of period and carry-over.
Section orderSection(const StudyRecord& record);
/// Recovered offsets by method.
Section perturbationSection(const StudyRecord& record);

}  // namespace plumbline::html_internal
