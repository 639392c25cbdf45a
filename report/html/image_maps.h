// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/html/figure.h"
#include "report/plots/plot_data.h"
#include "report/records/image_map.h"

namespace plumbline::html_internal {

/// "at 1 m", "at infinity".
std::string rangeText(double range_m);

/// Pixels between neighbouring points of the grid.
double stepX(const ImageMap& map);
double stepY(const ImageMap& map);

/// Whether the map has a grid, an image, and a value for each point.
bool sound(const ImageMap& map);

/// Axes of a plot over the image, wider by `margin` steps on each side.
PlotFrame mapFrame(const ImageMap& map, const std::string& title, double margin);

/// The values with lines of equal value; scaleAlike() gives maps that are compared one scale.
HeatMap heatMap(const ImageMap& map, const std::string& title, const std::string& label);

/// With median, largest value and clamp in the caption.
Figure heatFigure(const HeatMap& plot, const std::string& id);

}  // namespace plumbline::html_internal
