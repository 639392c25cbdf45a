// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <tuple>

#include "report/plots/plot_data.h"

namespace plumbline::internal {

template <class Plot>
using Drawer = std::string (*)(const Plot& plot, const std::string& id);

/// All versions of toSvg(): what the module plumbline_plots.so hands out under the name
/// `plumbline_plot_drawers`.
using PlotDrawers =
    std::tuple<Drawer<LinePlot>, Drawer<ScatterPlot>, Drawer<Histogram>, Drawer<HeatMap>,
               Drawer<VectorField>, Drawer<BarPlot>, Drawer<BoxPlot>>;

/// The drawers of the module at `path` (as dlopen() takes it), which stays loaded. The module is
/// asked for its build (`plumbline_plots_build`) first: where that is not kPlotsBuild, it is
/// unloaded again. nullptr, and `why` not, where it has none to give.
const PlotDrawers* drawersOf(const std::string& path, std::string& why);

}  // namespace plumbline::internal
