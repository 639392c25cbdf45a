// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "report/html/section.h"

namespace plumbline::html_internal {

/// Index of the name; their number where it is not among them.
inline std::size_t placeOf(const std::vector<std::string>& names, const std::string& name) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

/// The names of the rows, each once, in the order of their first.
template <class Rows, class Name>
std::vector<std::string> distinct(const Rows& rows, const Name& name) {
  std::vector<std::string> names;
  for (const auto& row : rows) {
    if (placeOf(names, name(row)) == names.size()) names.push_back(name(row));
  }
  return names;
}

/// Page of the session whose figure is nearest to a value, such as a median; "" where none has one.
template <class Sessions, class Get>
std::string pageNearest(const Sessions& sessions, double value, const Get& get) {
  std::string page;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& session : sessions) {
    const std::optional<double> own = get(session);
    if (!own || !(std::abs(*own - value) < least)) continue;
    least = std::abs(*own - value);
    page = session.page;
  }
  return page;
}

/// The section with one more figure, or as it is where there is nothing to draw.
inline Section withFigure(Section section, Figure figure) {
  if (!figure.svg.empty()) section.blocks.push_back({"", "", {}, {}, {std::move(figure)}});
  return section;
}

}  // namespace plumbline::html_internal
