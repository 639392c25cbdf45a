// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "report/html/figure.h"
#include "report/html/stage_view.h"

namespace plumbline::html_internal {

/// The RMSE of every frame over time, then for each camera: scatter and histogram of the errors,
/// their mean as a vector field over the image and their RMSE by region.
std::vector<FigureGroup> reprojectionFigures(const StageView& stage);

/// For each camera a map of how many corners fell where.
FigureGroup coverageFigures(const StageView& stage);

/// The correlation matrix of the stage's parameters; no figure without a covariance.
FigureGroup correlationFigures(const StageView& stage);

}  // namespace plumbline::html_internal
