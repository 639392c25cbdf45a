// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "report/html/study/sections.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

constexpr double kHighestRatio = 10;   // drawn: a wild one would flatten the others
constexpr double kShownTerm_m = 2e-5;  // below it a board's term is not drawn; the caption says so

/// Spread: of the estimates over the sessions of a method. Stated: by the calibrations themselves.
Table spreadTable(const StudyRecord& record) {
  Table table{{code("Parameter"), words("Method"), number("Sessions"), number("Weighted mean"),
               number("Spread"), number("Stated"), words("Unit"), number("Ratio"),
               number("95 % interval")}};
  for (const StudySpread& s : record.statistics.spread) {
    const auto [unit, factor] = readable(s.unit);
    Cell ratio = number("{:.2f}", s.ratio);
    // Deviations that are too large are worth a look as well.
    if (s.ratio > s.high || s.ratio < s.low) ratio.level = VerdictLevel::kCaution;
    table.rows.push_back({code(s.parameter), words(s.method), number(s.sessions),
                          number(withPrecisionOf(factor * s.mean, factor * s.std)),
                          number(twoDigits(factor * s.std)),
                          number(twoDigits(factor * s.stated_std)), words(unit), ratio,
                          number("{:.2f} to {:.2f}", s.low, s.high)});
  }
  return table;
}

/// Across the plot: what the sessions state, and the ends of the interval.
void addLevels(LinePlot& plot, double low, double high, double right) {
  for (const double level : {low, 1.0, high}) {
    // A colour each, and one name for both ends: hover.js knows a series by its colour.
    const bool stated = level == 1;
    plot.series.push_back({stated         ? "stated deviation"
                           : level == low ? "95 % interval"
                                          : "",
                           {-0.5, right},
                           {level, level},
                           stated ? Colour{90, 98, 110, 255} : Colour{150, 120, 80, 255},
                           1.2,
                           !stated,
                           false});
  }
}

Figure spreadFigure(const StudyRecord& record) {
  const auto& all = record.statistics.spread;
  const auto names = distinct(all, [](const StudySpread& s) { return s.parameter; });
  if (names.empty()) return {};
  LinePlot plot;
  // The axis reaches 2 at least, so that 1 is no edge of it.
  double top = 2;
  std::size_t beyond = 0;
  double low = 0, high = std::numeric_limits<double>::infinity();
  for (const StudySpread& s : all) {
    const StudySession* farthest = sessionOf(record, s.farthest);
    const std::size_t k = placeOf(record.methods, s.method);
    // The methods of a parameter stand side by side about its name.
    const double x =
        static_cast<double>(placeOf(names, s.parameter)) +
        0.25 * (static_cast<double>(k) - 0.5 * static_cast<double>(record.methods.size() - 1));
    beyond += s.ratio > kHighestRatio ? 1 : 0;
    plot.points.push_back({x, std::min(s.ratio, kHighestRatio),
                           fmt::format("{}, {}: {:.2f}; farthest from the mean: {}", s.parameter,
                                       s.method, s.ratio, s.farthest),
                           farthest ? farthest->page : "", seriesColour(k)});
    top = std::max(top, std::min(s.ratio, kHighestRatio));
    // The narrowest interval of all: that of the method with most sessions.
    low = std::max(low, s.low);
    high = std::min(high, s.high);
  }
  if (std::isfinite(high)) top = std::max(top, high);
  const double right = static_cast<double>(names.size()) - 0.5;
  addLevels(plot, low, high, right);
  for (std::size_t k = 0; k < record.methods.size(); ++k) {
    plot.series.push_back({record.methods[k], {}, {}, seriesColour(k), 2});
  }
  plot.frame = {"Spread over sessions relative to the stated deviation",
                {"", Range{-0.5, right}, {}, false, true},
                {"ratio", Range{0, 1.08 * top}},
                960,
                380};
  for (std::size_t i = 0; i < names.size(); ++i) {
    plot.frame.x.ticks.push_back({static_cast<double>(i), names[i]});
  }
  std::string caption =
      "1: the sessions of one rig spread as each of them states; a point links to the session "
      "farthest from the mean. Dashed: 95 % interval of the ratio if the stated deviations are "
      "true (for the method with most sessions).";
  if (beyond > 0) {
    caption += fmt::format(" Ratios above {:g} stand there ({}); the table has their values.",
                           kHighestRatio, beyond);
  }
  return {toSvg(plot, "study-spread"), caption, true};
}

}  // namespace

Section spreadSection(const StudyRecord& record) {
  Section section{"spread", "Stated deviations and the spread over sessions",
                  "Sessions of one rig should spread as much as each of them states. Ratio: "
                  "sqrt(chi\u00b2 / (n \u2212 1)) about the weighted mean; above its interval the "
                  "deviations are too small, below too large."};
  Table table = spreadTable(record);
  if (table.rows.empty()) return section;
  section.blocks.push_back(figureBlock("", {spreadFigure(record)}));
  section.blocks.push_back({"Every parameter", "", std::move(table)});
  return section;
}

Section boardSection(const StudyRecord& record) {
  Section section{"board", "The board over the sessions",
                  "Terms of the target's shape as each calibration estimated it. A trend may be "
                  "the board's, or that of anything else which changed between the sessions."};
  LinePlot plot;
  // 0, the board as stated, is always in view.
  std::vector<double> ends{0};
  for (int j = 0; j < kTargetTerms; ++j) {
    Series line{kTargetTermNames[static_cast<std::size_t>(j)],
                {},
                {},
                seriesColour(plot.series.size()),
                1.4};
    std::vector<NamedPoint> points;
    double largest_m = 0;
    for (std::size_t i = 0; i < record.sessions.size(); ++i) {
      const StudySession& s = record.sessions[i];
      if (!s.board) continue;
      const double mm = 1e3 * s.board->terms[j];
      largest_m = std::max(largest_m, std::abs(s.board->terms[j]));
      const auto x = static_cast<double>(i + 1);
      line.x.push_back(x);
      line.y.push_back(mm);
      points.push_back(
          {x, mm, fmt::format("{}, {}: {:+.3f} mm", s.name, line.name, mm), s.page, line.colour});
    }
    // One session shows no drift.
    if (line.x.size() < 2 || largest_m < kShownTerm_m) continue;
    ends.insert(ends.end(), line.y.begin(), line.y.end());
    plot.points.insert(plot.points.end(), points.begin(), points.end());
    plot.series.push_back(std::move(line));
  }
  if (plot.series.empty()) return section;
  plot.frame = {"Shape of the board",
                sessionAxis(record.sessions.size()),
                {"RMS displacement, signed as the term [mm]", rangeOf({&ends}, 0.08)},
                960,
                380};
  return withFigures(std::move(section), {{toSvg(plot, "study-board"),
                                           "Terms that stay below 0.02 mm are not shown.", true}});
}

}  // namespace plumbline::html_internal
