// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "evaluate/metrics/verdict.h"
#include "report/records/comparison_record.h"

namespace plumbline {

/// A map in brief.
struct MapExtremes {
  double worst = std::numeric_limits<double>::quiet_NaN();  ///< of its numbers; NaN without one
  std::size_t at = 0;                                       ///< its place among them
  double centre = 0;     ///< the middle grid point: the image's where columns and rows are odd
  double undefined = 0;  ///< share of the grid without a number
};
MapExtremes extremesOf(const ImageMap& map);

/// "a, b, ...": the first of these names, and whether there are more.
std::string firstNames(std::vector<std::string> names, std::size_t most);

/// Whether a calibration is known to be from other data than the session.
bool isHeldOut(const ComparisonRecord& record, const std::string& label);

/// What a comparison says, in the order in which it is read: parameters that differ beyond their
/// deviations, transforms and offsets, the worst projection difference of each pair and camera with
/// its value at the centre, which calibration predicts corners better, calibrations that could not
/// be scored; then the lint of every calibration.
std::vector<Finding> comparisonFindings(const ComparisonRecord& record);

/// What a reader asks of a comparison first, for every calibration but the first: which predicts
/// corners better and by how much (pooled over cameras, 95 % interval of the paired difference;
/// only "better" where it excludes zero), and by how much they differ over the image, in T_SC0 and
/// in the time offset; then which of three and more stands alone, and in what (loneParameters()).
std::string comparisonHeadline(const ComparisonRecord& record);

}  // namespace plumbline
