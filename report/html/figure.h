// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace plumbline::html_internal {

/// A plot with the sentence or two that tell what to look for.
struct Figure {
  std::string svg;
  std::string caption;
  bool wide = false;  ///< takes the whole width of the page
};

/// Figures under a heading of their own within a section.
struct FigureGroup {
  std::string heading;  ///< empty: none
  std::vector<Figure> figures;
};

}  // namespace plumbline::html_internal
