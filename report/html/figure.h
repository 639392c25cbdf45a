// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "report/html/section.h"
#include "report/plots/plot_data.h"
#include "report/records/image_map.h"

namespace plumbline::html_internal {

/// Adds those of the values that are finite to `known`.
void addFinite(const std::vector<double>& values, std::vector<double>& known);

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

/// One colour scale for maps that a reader compares: 0 to the 98 % quantile of all their cells, so
/// that one cell does not pale the rest.
void scaleAlike(const std::vector<HeatMap*>& maps);

/// " Colours end at 0.81 px; the largest is 3.2 px." where a cell of the map lies above its scale.
std::string clampText(const HeatMap& map);

/// One magnification for fields that a reader compares: an arrow of the 90 % quantile of all spans
/// `reach` on the axes; the key shows a round length; arrows above twice the quantile are cut.
void magnifyAlike(const std::vector<VectorField*>& fields, double reach);

/// " 3 arrows above 0.62 px are cut there and red." where some are.
std::string cutText(const VectorField& field);

/// Pointers to all of them, as scaleAlike() and magnifyAlike() take.
template <class Plot>
std::vector<Plot*> addressesOf(std::vector<Plot>& plots) {
  std::vector<Plot*> addresses;
  for (Plot& plot : plots) addresses.push_back(&plot);
  return addresses;
}

}  // namespace plumbline::html_internal
