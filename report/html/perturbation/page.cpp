// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/page.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "report/html/pages.h"
#include "report/html/perturbation/sections.h"
#include "report/html/text.h"
#include "report/plots/svg.h"

namespace plumbline {
namespace {

using namespace html_internal;

constexpr double kShownSigma = 3;  // ends of the colours; the page says so

std::vector<CaseGroup> groupedCases(const PerturbationRecord& record) {
  std::vector<CaseGroup> groups;
  for (const PerturbationCase& c : record.cases) {
    auto group = std::ranges::find(groups, c.kind, &CaseGroup::kind);
    if (group == groups.end()) group = groups.insert(groups.end(), {c.kind, {}});
    group->cases.push_back(&c);
  }
  return groups;
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
  Section section{
      "cases", "All cases",
      "One calibration a row, the first of each table without any change. Error is "
      "recovered \u2212 injected \u2212 base; where no offset was injected it is the "
      "change of the offset. Standard deviations are formal: they follow from the assumed noise. "
      "\u03c3 is the base's."};
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
  Section section{"base", "Base calibration",
                  "The reference of all cases. Its standard deviations are formal: they follow "
                  "from the assumed noise and include what the camera stage leaves open."};
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
                     "formal std " + stdText(record.base) + " ms"});
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
