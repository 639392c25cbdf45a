// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "report/html/section.h"
#include "report/html/text.h"
#include "report/records/comparison_record.h"

namespace plumbline::html_internal {

/// Label, tool, file, cameras and lint of every calibration.
Section calibrationsSection(const ComparisonRecord& record);
/// Every parameter side by side; significance in words and colour.
Section comparedParametersSection(const ComparisonRecord& record);
/// The same against what the session gives when it is calibrated itself; empty without a session.
Section sessionEstimateSection(const ComparisonRecord& record);
Section transformsSection(const ComparisonRecord& record);
Section offsetsSection(const ComparisonRecord& record);

/// Scores on recordings, as table and bars; which predicts better, view by view.
Section scoresSection(const ComparisonRecord& record);
Section entropySection(const ComparisonRecord& record);

/// |d| and d over the image of each camera, and the uncertainties.
Section differenceSection(const ComparisonRecord& record);
Section uncertaintySection(const ComparisonRecord& record);

}  // namespace plumbline::html_internal
