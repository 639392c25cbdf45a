// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include "report/html/perturbation/sections.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

constexpr double kLeastError = 1e-12;  // [s] below, an error is drawn here
// Not that of the failed cases: hover.js knows a series by its colour.
constexpr Colour kBoundColour{110, 40, 150, 255};

/// 10^exponent seconds in the unit of its three decades: "10 ns" for -8.
std::string decadeLabel(int exponent) {
  static const char* const kUnits[] = {"ps", "ns", "\u00b5s", "ms", "s"};
  const int group = std::clamp(exponent + 12, 0, 14) / 3;
  const int power = exponent + 12 - 3 * group;
  return fmt::format("{:g} {}", std::pow(10, power), kUnits[group]);
}

/// What the basin's axes span, and where failures stand.
struct BasinScale {
  double low = 0, high = 0;  ///< log10 of seconds
  double failed = 0;
  Range x;
};

BasinScale scaleOf(const PerturbationRecord& record, const CaseGroup& shifts) {
  // The bound is in view in any case, as its line is what the points are held against; so is 0,
  // where nothing was injected.
  double least = record.offset_bound_s, most = record.offset_bound_s;
  double from = 0, to = 0;
  for (const PerturbationCase* c : shifts.cases) {
    from = std::min(from, c->amount);
    to = std::max(to, c->amount);
    if (!c->problem.empty() || !std::isfinite(c->offset_error_s)) continue;
    const double error = std::max(kLeastError, std::abs(c->offset_error_s));
    least = std::min(least, error);
    most = std::max(most, error);
  }
  BasinScale scale;
  scale.low = std::floor(std::log10(least) - 0.2);
  // Two decades at least, and a fifth of one as air at either end.
  scale.high = std::max(scale.low + 2, std::ceil(std::log10(most) + 0.2));
  // Above all errors, on a line of their own.
  scale.failed = scale.high + 0.6;
  // With a floor for a study of one shift, whose axis would have no length.
  const double margin = std::max(1e-6, 0.04 * (to - from));
  scale.x = {from - margin, to + margin};
  return scale;
}

/// A dashed line over all of the axis, at the logarithm that the axis runs in.
Series level(const std::string& name, double value_s, const BasinScale& scale, Colour colour) {
  const double y = std::log10(value_s);
  return {name, {scale.x.min, scale.x.max}, {y, y}, colour, 1.2, true};
}

/// A tick for every decade, and one for the line of the failures.
std::vector<AxisTick> decades(const BasinScale& scale, bool any_failed) {
  std::vector<AxisTick> ticks;
  for (int e = static_cast<int>(scale.low); e <= static_cast<int>(scale.high); ++e) {
    ticks.push_back({static_cast<double>(e), decadeLabel(e)});
  }
  if (any_failed) ticks.push_back({scale.failed, "failed"});
  return ticks;
}

Series markers(const std::string& name, Colour colour) {
  return {name, {}, {}, colour, 7, false, true};
}

/// Of a single offset a plot shows no basin.
bool isOneOffset(const CaseGroup& shifts) {
  return std::ranges::count(shifts.cases, shifts.cases.front()->amount,
                            &PerturbationCase::amount) == std::ssize(shifts.cases);
}

/// Injected offset against |recovered - injected - base| on decades, failures along the top.
Figure basinFigure(const PerturbationRecord& record, const CaseGroup& shifts) {
  const BasinScale scale = scaleOf(record, shifts);
  Series late = markers("overestimated", seriesColour(0));
  Series early = markers("underestimated", seriesColour(2));
  // On a line of their own, above all values.
  Series failed = markers("failed", kWarningColour);
  for (const PerturbationCase* c : shifts.cases) {
    // A solution without an offset is a failure here.
    const bool solved = c->problem.empty() && std::isfinite(c->offset_error_s);
    Series& series = !solved ? failed : c->offset_error_s < 0 ? early : late;
    series.x.push_back(c->amount);
    series.y.push_back(solved ? std::log10(std::max(kLeastError, std::abs(c->offset_error_s)))
                              : scale.failed);
  }
  LinePlot plot;
  const bool any_failed = !failed.x.empty();
  const double top = any_failed ? scale.failed + 0.4 : scale.high;
  const bool one = isOneOffset(shifts);
  plot.frame = {std::string(one ? "Injected offset" : "Convergence basin") +
                    ": |recovered \u2212 injected \u2212 base|",
                {"injected offset [ms]", scale.x},
                {"error of the recovered offset", Range{scale.low, top}, decades(scale, any_failed),
                 false, false, true},
                960,
                400};
  if (any_failed) plot.frame.y.highest = scale.high;
  plot.series.push_back(level(
      fmt::format("bound{}, {:g} ms", one ? "" : " of the basin", 1e3 * record.offset_bound_s),
      record.offset_bound_s, scale, kBoundColour));
  const double std = record.base.time_offset_std_s.value_or(0);
  // A line outside of the axes would only stand in the legend.
  if (std > std::pow(10, scale.low) && std < std::pow(10, scale.high)) {
    plot.series.push_back(level("std of the base's offset", std, scale, {90, 98, 110, 255}));
  }
  for (Series& series : {std::ref(late), std::ref(early), std::ref(failed)}) {
    if (!series.x.empty()) plot.series.push_back(std::move(series));
  }
  const std::string each =
      "Each point is one calibration from its own initial guess, with every IMU stamp shifted by "
      "the injected offset. Points far below the standard deviation of the base's offset mean that "
      "the result does not depend on the initial offset of the clocks there; ";
  return {toSvg(plot, "perturbation-basin"),
          each +
              (one ? "no other offset was tested, so this shows no range of offsets."
                   : "between the points nothing was tested. The basin ends where points rise "
                     "above the dashed line of the bound or fail.") +
              " Errors below 1 ps are drawn there.",
          true};
}

}  // namespace

Section basinSection(const PerturbationRecord& record, const std::vector<CaseGroup>& groups) {
  Section section{
      "basin", "Convergence basin",
      "Every IMU stamp is shifted by a known offset, and the calibration runs again from its own "
      "initial guess. Since t_imu = t_cam + t_d, the recovered offset must grow by exactly what "
      "was injected: error = recovered \u2212 injected \u2212 base."};
  for (const CaseGroup& group : groups) {
    if (group.kind != kShift) continue;
    if (isOneOffset(group)) section.title = "Injected time offset";
    section.blocks.push_back(figureBlock("", {basinFigure(record, group)}));
  }
  return section;
}

}  // namespace plumbline::html_internal
