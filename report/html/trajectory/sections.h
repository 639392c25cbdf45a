// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "report/html/page.h"
#include "report/html/section.h"
#include "report/html/text.h"
#include "report/plots/plot_data.h"
#include "report/records/trajectory_record.h"

namespace plumbline::html_internal {

/// Position errors as boxes, one per sequence and calibration.
Section errorSection(const std::vector<TrajectoryRun>& runs);
/// Top and side view of the runs with their truth, coloured by error; the first dozen.
Section overlaySection(const std::vector<TrajectoryRun>& runs);
/// Position and rotation errors over time, one plot of each per sequence.
Section timeSection(const std::vector<TrajectoryRun>& runs);
/// Relative errors by distance.
Section relativeSection(const std::vector<TrajectoryRun>& runs);

/// Axes of a box plot whose names may be many; `label` with its unit is that of the values.
void frameBoxes(BoxPlot& plot, const std::string& title, const std::string& label);

/// All sections of a trajectory page, for the comparison page too; sections that no run has
/// anything for have no blocks.
std::vector<Section> trajectorySections(const TrajectoryStudy& study);

/// Runs, completion, and the median error of every calibration.
std::vector<Card> trajectoryCards(const TrajectoryStudy& study);

/// Every run, complete or not, completion per calibration, and what was odd.
Section runsSection(const TrajectoryStudy& study);
/// Paired differences of the calibrations, with the tests.
Section pairedSection(const std::vector<PairedDifference>& differences);
/// Clock offsets, hand-eye transforms, NEES.
Section clockSection(const std::vector<TrajectoryRun>& runs);
Section handEyeSection(const std::vector<TrajectoryRun>& runs);
Section neesSection(const std::vector<TrajectoryRun>& runs);
/// What the odometry says of itself, without any truth.
Section selfSection(const std::vector<TrajectoryRun>& runs);
/// What each parameter of a calibration does to the error.
Section sensitivitySection(const std::vector<CalibrationSensitivity>& list);
/// How stamps were paired, and what was odd about them.
Section associationSection(const std::vector<TrajectoryRun>& runs);

/// "MH_01 · kalibr · 3": what is known of the run's place; otherwise its file.
std::string runName(const TrajectoryRun& run);

/// `table` without the columns that hold nothing but dashes.
Table withoutEmptyColumns(Table table);

/// Names of the calibrations, in order of appearance.
std::vector<std::string> calibrationsOf(const std::vector<TrajectoryRun>& runs);

/// The sequences of runs, in their order.
std::vector<std::string> sequencesOf(const std::vector<TrajectoryRun>& runs);

}  // namespace plumbline::html_internal
