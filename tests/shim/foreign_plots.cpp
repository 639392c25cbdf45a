// SPDX-License-Identifier: BSD-3-Clause
// A module of plots from another build: it must be asked for its build, and for nothing else.
extern "C" {
extern const int plumbline_plot_drawers;
const int plumbline_plot_drawers = 0;
const char* plumbline_plots_build();
const char* plumbline_plots_build() { return "0.0.1 (plots 0123456789ab)"; }
}
