// SPDX-License-Identifier: BSD-3-Clause
// svg.h for programs that draw rarely: VTK is loaded with the first plot, and stays.
#include <dlfcn.h>

#include "calibrator/base/error.h"
#include "report/plots/plots_module.h"
#include "report/plots/svg.h"

namespace plumbline {
namespace {

constexpr const char* kModule = "plumbline_plots.so";

/// Beside the program, where an installation has it, or in the build tree (the program's run path).
/// dlopen() itself fills in $ORIGIN.
void* open() {
  const std::string name = kModule;
  for (const std::string& path : {"$ORIGIN/" + name, "$ORIGIN/../lib/plumbline/" + name, name}) {
    if (void* const module = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL)) return module;
  }
  return nullptr;
}

internal::PlotDrawers load() {
  void* const module = open();
  void* const drawers = module == nullptr ? nullptr : ::dlsym(module, "plumbline_plot_drawers");
  if (drawers == nullptr) {
    throw InputError(kModule, 0,
                     std::string("plots cannot be drawn (") + ::dlerror() +
                         "); put this file next to the program, or run without the report");
  }
  return *static_cast<const internal::PlotDrawers*>(drawers);
}

const internal::PlotDrawers& drawers() {
  // A failure throws, and the next plot tries again.
  static const internal::PlotDrawers loaded = load();
  return loaded;
}

template <class Plot>
std::string draw(const Plot& plot, const std::string& id) {
  return std::get<internal::Drawer<Plot>>(drawers())(plot, id);
}

}  // namespace

std::string toSvg(const LinePlot& plot, const std::string& id) { return draw(plot, id); }
std::string toSvg(const ScatterPlot& plot, const std::string& id) { return draw(plot, id); }
std::string toSvg(const Histogram& plot, const std::string& id) { return draw(plot, id); }
std::string toSvg(const HeatMap& plot, const std::string& id) { return draw(plot, id); }
std::string toSvg(const VectorField& plot, const std::string& id) { return draw(plot, id); }
std::string toSvg(const BarPlot& plot, const std::string& id) { return draw(plot, id); }
std::string toSvg(const BoxPlot& plot, const std::string& id) { return draw(plot, id); }

}  // namespace plumbline
