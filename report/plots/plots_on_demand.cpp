// SPDX-License-Identifier: BSD-3-Clause
// svg.h for programs that draw rarely: VTK is loaded with the first plot, and stays.
#include <dlfcn.h>
#include <link.h>

#include "calibrator/base/error.h"
#include "generated/plots_build.h"
#include "generated/report/embedded.h"
#include "report/plots/plots_module.h"
#include "report/plots/svg.h"

namespace plumbline {
namespace {

constexpr const char* kModule = "plumbline_plots.so";

/// Beside the program, where an installation has it, or in the build tree (the program's run path).
/// dlopen() itself fills in $ORIGIN. Says why not of a file that is there, rather than of one that
/// is not.
internal::PlotDrawers load() {
  const std::string name = kModule;
  const std::string missing = name + ": cannot open shared object file: No such file";
  std::string why;
  for (const std::string& path : {"$ORIGIN/" + name, "$ORIGIN/../lib/plumbline/" + name, name}) {
    std::string error;
    if (const internal::PlotDrawers* const found = internal::drawersOf(path, error)) return *found;
    if (why.empty() || why.find(missing) != std::string::npos) why = error;
  }
  throw InputError(kModule, 0,
                   "plots cannot be drawn (" + why +
                       "); put the file that was built with the program next to it, or run "
                       "without the report");
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

namespace internal {

const PlotDrawers* drawersOf(const std::string& path, std::string& why) {
  void* const module = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr) {
    why = ::dlerror();
    return nullptr;
  }
  const auto ask = reinterpret_cast<const char* (*)()>(::dlsym(module, "plumbline_plots_build"));
  const std::string build = ask == nullptr ? "unknown" : ask();
  const void* const drawers = ::dlsym(module, "plumbline_plot_drawers");
  if (build == kPlotsBuild && drawers != nullptr) return static_cast<const PlotDrawers*>(drawers);
  const link_map* file = nullptr;
  ::dlinfo(module, RTLD_DI_LINKMAP, &file);
  why = std::string(file->l_name) + " is of another build: " + build + ", the program's is " +
        kPlotsBuild;
  ::dlclose(module);
  return nullptr;
}

}  // namespace internal

const std::string& plotScripts() {
  static const std::string scripts = embedded::hover_js() + embedded::zoom_js();
  return scripts;
}

std::string toSvg(const LinePlot& plot, const std::string& id) { return draw(plot, id); }
std::string toSvg(const ScatterPlot& plot, const std::string& id) { return draw(plot, id); }
std::string toSvg(const Histogram& plot, const std::string& id) { return draw(plot, id); }
std::string toSvg(const HeatMap& plot, const std::string& id) { return draw(plot, id); }
std::string toSvg(const VectorField& plot, const std::string& id) { return draw(plot, id); }
std::string toSvg(const BarPlot& plot, const std::string& id) { return draw(plot, id); }
std::string toSvg(const BoxPlot& plot, const std::string& id) { return draw(plot, id); }

}  // namespace plumbline
