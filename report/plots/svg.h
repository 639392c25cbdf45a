// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "report/plots/plot_data.h"

namespace plumbline {

/// Each function draws one plot with VTK's charts on the CPU (no display, no OpenGL) and returns an
/// inline <svg> element. `id` becomes the element's id and prefixes every other id within; it must
/// be unique in the page and made of letters, digits, '-' and '_'. Equal data give equal bytes.
///
/// The element carries data-ax="x0 x1 y0 y1 px0 px1 py0 py1": the values at the ends of the axes
/// and the pixels (of the viewBox) on which VTK put them; plotScripts() read it. data-log="x", "y"
/// or "xy" names the axes on which these are log10 of the values, and data-highest the end of y
/// above which a point has no value. No text contains NaN: points that are not finite are left out.
///
/// VTK's text measuring is not thread-safe: call these from one thread at a time.
std::string toSvg(const LinePlot& plot, const std::string& id);
std::string toSvg(const ScatterPlot& plot, const std::string& id);
std::string toSvg(const Histogram& plot, const std::string& id);
std::string toSvg(const HeatMap& plot, const std::string& id);
std::string toSvg(const VectorField& plot, const std::string& id);
std::string toSvg(const BarPlot& plot, const std::string& id);
std::string toSvg(const BoxPlot& plot, const std::string& id);

/// Scripts that show the value of the nearest point while the pointer moves over a plot, and zoom
/// it; they go into the page once, after the plots.
const std::string& plotScripts();

/// About `target` ticks (0.6 to 1.5 times as many) at round numbers (1, 2 or 5 times a power of
/// ten) inside [range.min, range.max], ascending, labelled with just the digits that tell them
/// apart. range.min < range.max; target >= 2.
std::vector<AxisTick> roundTicks(const Range& range, int target);

/// Smallest range over the finite values with `margin` (a share of the span) on either side; never
/// empty: a single value gets a span of its own, no value gives [0, 1].
Range rangeOf(const std::vector<const std::vector<double>*>& columns, double margin);

}  // namespace plumbline

namespace plumbline::internal {

/// Deep blue to yellow, lightness rising steadily; 0 <= u <= 1 (clamped).
Colour sequentialColour(double u);

/// Blue over white (u = 0.5) to red; clamped.
Colour divergingColour(double u);
Colour errorColour(double u);  ///< green to dark violet: lines on white

}  // namespace plumbline::internal
