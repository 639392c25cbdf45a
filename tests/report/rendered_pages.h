// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "report/html/pages.h"
#include "tests/report/markup.h"
#include "tests/report/synthetic_studies.h"
#include "tests/report/synthetic_user_study.h"

namespace plumbline::test {

inline constexpr double kDrawnPixel = 0.11;  // coordinates are written to a tenth of a pixel

inline std::string renderPerturbation() { return renderPerturbationPage(syntheticPerturbation()); }
inline std::string renderTrajectory() { return renderTrajectoryPage(syntheticTrajectories()); }
inline std::string renderUserStudy() { return renderStudyPage(syntheticUserStudy()); }
inline std::string renderComparison() { return renderComparisonPage(syntheticComparison()); }

// Each page is rendered once for all tests that only read it.
inline const std::string& perturbationPage() {
  static const std::string page = renderPerturbation();
  return page;
}
inline const std::string& trajectoryPage() {
  static const std::string page = renderTrajectory();
  return page;
}
inline const std::string& userStudyPage() {
  static const std::string page = renderUserStudy();
  return page;
}
inline const std::string& comparisonPage() {
  static const std::string page = renderComparison();
  return page;
}

inline std::vector<std::string> between(const std::string& text, const std::string& open,
                                        const std::string& close) {
  std::vector<std::string> found;
  for (std::size_t at = text.find(open); at != std::string::npos; at = text.find(open, at)) {
    const std::size_t last = text.find(close, at);
    if (last == std::string::npos) break;
    found.push_back(text.substr(at, last + close.size() - at));
    at = last + close.size();
  }
  return found;
}

inline std::size_t countOf(const std::string& text, const std::string& what) {
  return between(text, what, what.substr(what.size() - 1)).size();
}

inline std::string plot(const std::string& page, const std::string& id) {
  for (const std::string& svg : between(page, "<svg ", "</svg>")) {
    if (svg.find("id=\"" + id + "\"") != std::string::npos) return svg;
  }
  return "";
}

/// Every point drawn as a line or a marker.
inline std::vector<std::pair<double, double>> pointsOf(const std::string& svg) {
  std::vector<std::pair<double, double>> points;
  for (const char* attribute : {"points", "d"}) {
    for (const std::string& text : attributes(svg, attribute)) {
      const auto list = numbers(text);
      for (std::size_t i = 0; i + 1 < list.size(); i += 2)
        points.emplace_back(list[i], list[i + 1]);
    }
  }
  return points;
}

inline bool drawnAt(const std::string& svg, double x, double y) {
  for (const auto& [px, py] : pointsOf(svg)) {
    if (std::abs(px - x) <= kDrawnPixel && std::abs(py - y) <= kDrawnPixel) return true;
  }
  return false;
}

}  // namespace plumbline::test
