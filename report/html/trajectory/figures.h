// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "report/html/section.h"
#include "report/plots/plot_data.h"
#include "report/records/trajectory_record.h"

namespace plumbline::html_internal {

/// Position errors as boxes, one per sequence and calibration.
Section errorSection(const std::vector<TrajectoryRun>& runs);
/// Top and side view of the runs with their truth, coloured by error; the first dozen.
Section overlaySection(const std::vector<TrajectoryRun>& runs);
/// Position error over time, one plot per sequence.
Section timeSection(const std::vector<TrajectoryRun>& runs);
/// Relative errors by distance.
Section relativeSection(const std::vector<TrajectoryRun>& runs);

/// Axes of a box plot whose names may be many; `label` with its unit is that of the values.
void frameBoxes(BoxPlot& plot, const std::string& title, const std::string& label);

}  // namespace plumbline::html_internal
