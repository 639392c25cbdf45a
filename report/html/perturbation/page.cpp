// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/page.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "report/html/pages.h"
#include "report/html/perturbation/figures.h"

namespace plumbline {
namespace {

using namespace html_internal;

constexpr const char* kShift = "imu-shift";

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

std::vector<Cell> offsetCells(const PerturbationCase& c, bool is_base) {
  return {number(milliseconds(c)), number(stdText(c)),
          number(is_base ? kDash : microseconds(c.offset_error_s, "{:+.4g}"))};
}

std::vector<Cell> solvedRow(const PerturbationRecord& record, const PerturbationCase& c,
                            bool is_base) {
  std::vector<Cell> row = {{is_base ? "as recorded" : labelOf(c)}};
  if (hasOffset(record)) {
    for (Cell& cell : offsetCells(c, is_base)) row.push_back(std::move(cell));
  }
  row.push_back(number("{:.4f}", c.rmse_px));
  row.push_back(number(c.frames));
  row.push_back(number(c.iterations));
  row.push_back({is_base ? kDash : largestChange(record, c)});
  return row;
}

std::vector<Cell> failedRow(const PerturbationRecord& record, const PerturbationCase& c) {
  std::vector<Cell> row = {{labelOf(c)}};
  // The offset's three columns, RMSE, frames and iterations.
  for (int i = 0; i < (hasOffset(record) ? 6 : 3); ++i) row.push_back(number(kDash));
  row.push_back({"failed: " + c.problem, Cell::Kind::kText, VerdictLevel::kBad});
  return row;
}

Table casesTable(const PerturbationRecord& record, const CaseGroup& group) {
  Table table;
  table.columns = {words("Change")};
  const auto add = [&](std::initializer_list<Cell> more) {
    table.columns.insert(table.columns.end(), more);
  };
  if (hasOffset(record))
    add({number("Recovered offset [ms]"), number("Std [ms]"), number("Error [\u00b5s]")});
  add({number("RMSE [px]"), number("Frames"), number("Iterations"), words("Largest other change")});
  // First of all what every case is compared with.
  table.rows.push_back(solvedRow(record, record.base, true));
  for (const PerturbationCase* c : group.cases) {
    table.rows.push_back(c->problem.empty() ? solvedRow(record, *c, false) : failedRow(record, *c));
  }
  return table;
}

Section basinSection(const PerturbationRecord& record, const std::vector<CaseGroup>& groups) {
  Section section{
      "basin", "Convergence basin",
      "Every IMU stamp is shifted by a known offset, and the calibration runs again from its own "
      "initial guess. Since t_imu = t_cam + t_d, the recovered offset must grow by exactly what "
      "was injected: error = recovered \u2212 injected \u2212 base."};
  for (const CaseGroup& group : groups) {
    if (group.kind == kShift)
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
    const bool any = std::any_of(group.cases.begin(), group.cases.end(),
                                 [](const PerturbationCase* c) { return c->problem.empty(); });
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
  for (const PerturbationCase& c : record.cases) {
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
    cards.push_back({"Largest offset error", microseconds(worst, "{:.3g}"), "\u00b5s",
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
