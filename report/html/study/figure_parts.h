// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "report/html/section.h"
#include "report/html/text.h"

namespace plumbline::html_internal {

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
