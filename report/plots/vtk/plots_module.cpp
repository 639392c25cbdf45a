// SPDX-License-Identifier: BSD-3-Clause
#include "report/plots/plots_module.h"

#include "generated/plots_build.h"
#include "report/plots/svg.h"

using plumbline::toSvg;

extern "C" {
const char* plumbline_plots_build();
const char* plumbline_plots_build() { return plumbline::internal::kPlotsBuild; }

extern const plumbline::internal::PlotDrawers plumbline_plot_drawers;
const plumbline::internal::PlotDrawers plumbline_plot_drawers{toSvg, toSvg, toSvg, toSvg,
                                                              toSvg, toSvg, toSvg};
}
