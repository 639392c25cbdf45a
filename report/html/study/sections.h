// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>

#include "report/html/section.h"
#include "report/html/text.h"
#include "report/plots/plot_data.h"
#include "report/records/study_record.h"

namespace plumbline::html_internal {

/// Page of the session whose figure is nearest to a value, such as a median; "" where none has one.
std::string pageNearest(const auto& sessions, double value, const auto& get) {
  std::string page;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& session : sessions) {
    const std::optional<double> own = get(session);
    if (!own || !(std::abs(*own - value) < least)) continue;
    least = std::abs(*own - value);
    page = session.page;
  }
  return page;
}

/// Sessions in the study's order, counted from 1.
PlotAxis sessionAxis(std::size_t sessions);

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

// The tables of sessions, tools and nights of a study's page.

Section othersSection(const StudyRecord& record);
Section nightsSection(const StudyRecord& record);
/// Sessions without a calibration, whose participant gave up, or with a bad verdict, and why.
Section failuresSection(const StudyRecord& record);
Section sessionsSection(const StudyRecord& record);

/// A session's name, leading to its page.
Cell linkTo(const StudySession& session);
/// Of that name; null if there is none.
const StudySession* sessionOf(const StudyRecord& record, const std::string& name);

// What a study's statistics say: words and tables.

/// The sentences, each method's figures, effects by endpoint, tests of three methods or more.
Section resultsSection(const StudyRecord& record);
/// Effects of period and carry-over.
Section orderSection(const StudyRecord& record);
/// Recovered offsets by method.
Section perturbationSection(const StudyRecord& record);

}  // namespace plumbline::html_internal
