// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/guide_decision.h"

namespace plumbline {

/// A board bent across by so much (RMS), half as much the other way along, and a little stretched
/// by its printer (0.1 mm).
TargetShape bentBoard(double bend_mm);

/// suggestions.csv as readSuggestions() reads it.
std::string suggestionsCsv(const std::vector<Suggestion>& suggestions);

}  // namespace plumbline
