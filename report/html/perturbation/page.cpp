// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/page.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "report/html/pages.h"
#include "report/html/text.h"
#include "report/plots/svg.h"
#include "report/records/perturbation_record.h"

namespace plumbline {
namespace {

using namespace html_internal;

constexpr const char* kShift = "imu-shift";
constexpr double kLeastError = 1e-12;  // [s] below, an error is drawn here
constexpr double kShownSigma = 3;      // ends of the colours; the page says so
// Not that of the failed cases: hover.js knows a series by its colour.
constexpr Colour kBoundColour{110, 40, 150, 255};

/// The cases of one kind, in their order.
struct CaseGroup {
  std::string kind;  ///< as in PerturbationCase
  std::vector<const PerturbationCase*> cases;
};

std::vector<CaseGroup> groupedCases(const PerturbationRecord& record) {
  std::vector<CaseGroup> groups;
  for (const PerturbationCase& c : record.cases) {
    auto group = std::ranges::find(groups, c.kind, &CaseGroup::kind);
    if (group == groups.end()) group = groups.insert(groups.end(), {c.kind, {}});
    group->cases.push_back(&c);
  }
  return groups;
}

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

/// Change of parameter i in standard deviations; of the time offset what was not injected.
double changeOf(const PerturbationRecord& record, const PerturbationCase& c, std::size_t i) {
  if (!c.problem.empty() || i >= c.changes_sigma.size()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const bool offset = c.kind == kShift && record.parameters[i] == "time_offset";
  if (!offset) return c.changes_sigma[i];
  const double std = record.base.time_offset_std_s.value_or(0);
  return std > 0 ? c.offset_error_s / std : std::numeric_limits<double>::quiet_NaN();
}

/// As short as a cell wants it: each bound is where the format before would round to one digit
/// more. Below 0.05 nothing is written.
std::string changeText(double sigma) {
  const double size = std::abs(sigma);
  if (!(size >= 0.05)) return "";
  if (size < 9.95) return fmt::format("{:.1f}", sigma);
  if (size < 999.5) return fmt::format("{:.0f}", sigma);
  return size < 9.995e5 ? fmt::format("{:.0f}k", sigma / 1e3) : fmt::format("{:.0e}", sigma);
}

/// "Shifted IMU stamps" for "imu-shift"; a kind without words of its own stands as it is.
std::string titleOf(const std::string& kind) {
  static const std::pair<const char*, const char*> kTitles[] = {
      {kShift, "Shifted IMU stamps"},
      {"target-size", "Stated target size"},
      {"noise-densities", "Noise densities multiplied"},
      {"initial-intrinsics", "Other initial focal lengths"},
      {"dropped-frames", "Dropped frames"},
      {"dropped-imu", "Dropped IMU samples"},
      {"corner-noise", "Noise added to corners"}};
  for (const auto& [word, title] : kTitles) {
    if (kind == word) return title;
  }
  return kind;
}

/// "+10 ms", "x2", with the seed of random ones.
std::string labelOf(const PerturbationCase& c) {
  std::string label = amountText(c);
  if (c.seed != 0) label += fmt::format(", seed {}", c.seed);
  return label;
}

/// Of a single offset a plot shows no basin.
bool isOneOffset(const CaseGroup& shifts) {
  return std::ranges::all_of(shifts.cases, [&](const PerturbationCase* c) {
    return c->amount == shifts.cases.front()->amount;
  });
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

/// Cases down, parameters across, changes in standard deviations of the base. `index` tells the
/// figures of a page apart: a kind read from a store may be any text.
Figure changeFigure(const PerturbationRecord& record, const CaseGroup& group, std::size_t index) {
  const auto columns = record.parameters.size();
  const auto rows = group.cases.size();
  HeatMap map;
  map.frame = {titleOf(group.kind) + ": change in standard deviations of the base",
               {"", Range{0, static_cast<double>(columns)}, {}, false, true},
               {"", Range{0, static_cast<double>(rows)}, {}, true},
               std::clamp(300 + 30 * static_cast<int>(columns), 480, 960),
               160 + std::clamp(20 * static_cast<int>(rows), 60, 900)};
  map.columns = static_cast<int>(columns);
  map.rows = static_cast<int>(rows);
  map.colours = ColourMap::kDiverging;
  map.value_range = Range{-kShownSigma, kShownSigma};
  map.value_label = "change [\u03c3]";
  for (std::size_t i = 0; i < columns; ++i) {
    map.frame.x.ticks.push_back({static_cast<double>(i) + 0.5, record.parameters[i]});
  }
  const std::size_t step = rows / 45 + 1;  // labels that do not touch
  for (std::size_t row = 0; row < rows; ++row) {
    const PerturbationCase& c = *group.cases[row];
    if (row % step == 0) map.frame.y.ticks.push_back({static_cast<double>(row) + 0.5, labelOf(c)});
    for (std::size_t i = 0; i < columns; ++i) {
      map.values.push_back(changeOf(record, c, i));
      map.cell_labels.push_back(step == 1 ? changeText(map.values.back()) : "");
    }
  }
  const bool any_failed = std::ranges::any_of(
      group.cases, [](const PerturbationCase* c) { return !c->problem.empty(); });
  return {toSvg(map, fmt::format("perturbation-changes-{}", index)),
          any_failed ? "Blank rows are cases that failed." : "", true};
}

/// Of the parameters but the time offset, whose error has a column of its own.
std::string largestChange(const PerturbationRecord& record, const PerturbationCase& c) {
  const auto worst = largestOtherChange(record.parameters, c);
  if (!worst) return kDash;
  const double sigma = c.changes_sigma[*worst];
  if (std::abs(sigma) < 0.01) return "below 0.01 \u03c3";
  return fmt::format("{} {:+.2g} \u03c3", record.parameters[*worst], sigma);
}

/// The recovered offset, to two digits of its deviation.
std::string milliseconds(const PerturbationCase& c) {
  return withPrecisionOf(1e3 * c.time_offset_s, 1e3 * c.time_offset_std_s.value_or(0));
}

/// Microseconds with four digits, down to a picosecond.
std::string microseconds(double seconds, const char* format) {
  if (std::abs(seconds) < 1e-12) return "< 1e-6";
  return fmt::format(fmt::runtime(format), 1e6 * seconds);
}

/// Of the recovered offset [ms].
std::string stdText(const PerturbationCase& c) {
  return c.time_offset_std_s ? twoDigits(1e3 * *c.time_offset_std_s) : kDash;
}

std::vector<Cell> caseRow(const PerturbationRecord& record, const PerturbationCase& c,
                          bool is_base) {
  if (!is_base && !c.problem.empty()) {
    std::vector<Cell> row(8, number(kDash));
    row.front() = {labelOf(c)};
    row.back() = {"failed: " + c.problem, Cell::Kind::kText, VerdictLevel::kBad};
    return row;
  }
  return {{is_base ? "as recorded" : labelOf(c)},
          number(milliseconds(c)),
          number(stdText(c)),
          number(is_base ? kDash : microseconds(c.offset_error_s, "{:+.4g}")),
          number("{:.4f}", c.rmse_px),
          number(c.frames),
          number(c.iterations),
          {is_base ? kDash : largestChange(record, c)}};
}

Table casesTable(const PerturbationRecord& record, const CaseGroup& group) {
  Table table{{words("Change"), number("Recovered offset [ms]"), number("Std [ms]"),
               number("Error [\u00b5s]"), number("RMSE [px]"), number("Frames"),
               number("Iterations"), words("Largest other change")}};
  // First of all what every case is compared with.
  table.rows.push_back(caseRow(record, record.base, true));
  for (const PerturbationCase* c : group.cases) table.rows.push_back(caseRow(record, *c, false));
  if (!hasOffset(record)) eraseColumns(table, 1, 3);
  return table;
}

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

Section changeSection(const PerturbationRecord& record, const std::vector<CaseGroup>& groups) {
  Section section{"changes", "Other changes",
                  "The change of every parameter in standard deviations of the base calibration; "
                  "for the time offset, minus the injected offset. White: unchanged; colours end "
                  "at 3 \u03c3, numbers are given from 0.05 \u03c3."};
  if (record.parameters.empty()) return section;
  for (const CaseGroup& group : groups) {
    // A map of blank rows would show nothing.
    const bool any = std::ranges::any_of(
        group.cases, [](const PerturbationCase* c) { return c->problem.empty(); });
    if (!any) continue;
    section.blocks.push_back(figureBlock("", {changeFigure(record, group, section.blocks.size())}));
  }
  return section;
}

Section casesSection(const PerturbationRecord& record, const std::vector<CaseGroup>& groups) {
  Section section{"cases", "All cases",
                  "One calibration a row, the first of each table without any change. Error is "
                  "recovered \u2212 injected \u2212 base; where no offset was injected it is the "
                  "change of the offset. \u03c3 is the base's standard deviation."};
  for (const CaseGroup& group : groups) {
    section.blocks.push_back({titleOf(group.kind), "", casesTable(record, group)});
  }
  return section;
}

Section baseSection(const PerturbationRecord& record) {
  Table table{{code("Parameter"), number("Estimate"), number("Std"), words("Unit")}};
  for (std::size_t i = 0; i < std::min(record.parameters.size(), record.base.values.size()); ++i) {
    const auto [unit, factor] = readable(i < record.units.size() ? record.units[i] : "");
    const double std = i < record.base_std.size() ? record.base_std[i] : 0;
    table.rows.push_back({code(record.parameters[i]),
                          number(withPrecisionOf(factor * record.base.values[i], factor * std)),
                          number(twoDigits(factor * std)), words(unit)});
  }
  Section section{"base", "Base calibration", "The reference of all cases."};
  return withTable(std::move(section), std::move(table));
}

std::vector<Card> cardsOf(const PerturbationRecord& record) {
  std::size_t failed = 0;
  // Below 0: no shifted case has a solution.
  double worst = -1, at = 0;
  std::size_t shifts = 0;
  for (const PerturbationCase& c : record.cases) {
    if (c.kind == kShift) ++shifts;
    if (!c.problem.empty()) {
      ++failed;
    } else if (c.kind == kShift && isLarger(std::abs(c.offset_error_s), worst)) {
      worst = std::abs(c.offset_error_s);
      at = c.amount;
    }
  }
  std::vector<Card> cards = {
      {"Cases", std::to_string(record.cases.size()), "",
       fmt::format("{} solved, {} failed", record.cases.size() - failed, failed)},
      {"Base RMSE", fmt::format("{:.4f}", record.base.rmse_px), "px",
       fmt::format("{} frames, {} iterations", record.base.frames, record.base.iterations)}};
  if (hasOffset(record)) {
    cards.push_back({"Base time offset", milliseconds(record.base), "ms",
                     "std " + stdText(record.base) + " ms"});
  }
  if (!(worst < 0)) {  // also where it is not a number
    cards.push_back({shifts == 1 ? "Offset error" : "Largest offset error",
                     microseconds(worst, "{:.3g}"), "\u00b5s",
                     fmt::format("at {:+g} ms injected", at)});
  }
  return cards;
}

}  // namespace

std::string renderPerturbationPage(const PerturbationRecord& record) {
  const std::vector<CaseGroup> groups = groupedCases(record);
  return renderPage({"Perturbation study",
                     record.name,
                     record.provenance,
                     record.verdict,
                     cardsOf(record),
                     {basinSection(record, groups), changeSection(record, groups),
                      casesSection(record, groups), baseSection(record)},
                     record.assumptions});
}

}  // namespace plumbline
