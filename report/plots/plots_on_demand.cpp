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
/// dlopen() itself fills in $ORIGIN. `why` not: of a file that is there, rather than of one that is
/// not.
void* open(std::string& why) {
  const std::string name = kModule;
  const std::string missing = name + ": cannot open shared object file: No such file";
  for (const std::string& path : {"$ORIGIN/" + name, "$ORIGIN/../lib/plumbline/" + name, name}) {
    if (void* const module = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL)) return module;
    const std::string error = ::dlerror();
    if (why.empty() || why.find(missing) != std::string::npos) why = error;
  }
  return nullptr;
}

internal::PlotDrawers load() {
  std::string why;
  void* const module = open(why);
  void* const drawers = module == nullptr ? nullptr : ::dlsym(module, "plumbline_plot_drawers");
  if (drawers == nullptr) {
    if (module != nullptr) why = ::dlerror();
    throw InputError(kModule, 0,
                     "plots cannot be drawn (" + why +
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
