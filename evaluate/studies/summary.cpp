// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "evaluate/metrics/headline.h"
#include "evaluate/results/text.h"
#include "evaluate/studies/perturbation_study.h"

namespace plumbline {
namespace {

/// Of a time offset; without one nothing, which 0 would not say.
struct OffsetFigures {
  std::optional<double> value_s, std_s, error_s;
};

OffsetFigures offsetOf(const PerturbationRecord& record, const PerturbationCase& c) {
  if (!c.problem.empty() || !hasOffset(record)) return {};
  return {c.time_offset_s, c.time_offset_std_s, c.offset_error_s};
}

std::string cell(const std::optional<double>& value) {
  return value ? fmt::format("{}", *value) : "";
}

std::string fixed(const std::optional<double>& value, double factor, int decimals) {
  return value ? fmt::format("{:.{}f}", factor * *value, decimals) : "";
}

void addRow(Text& text, const PerturbationRecord& record, const PerturbationCase& c) {
  // Cells of a case that failed are empty: its figures would be those of where it stopped, or 0.
  const bool solved = c.problem.empty();
  const OffsetFigures offset = offsetOf(record, c);
  const std::string seed = c.seed == 0 ? "" : std::to_string(c.seed);  // 0: nothing was drawn
  add(text, "{},{},{},{},{},", c.kind, c.amount, c.unit, seed, solved ? "yes" : "no");
  add(text, "{}", solved ? fmt::format("{},{},{}", c.rmse_px, c.frames, c.iterations) : ",,");
  add(text, ",{},{},{},{}", cell(offset.value_s), cell(offset.std_s), cell(offset.error_s),
      csvCell(c.problem));
  for (std::size_t i = 0; i < record.parameters.size(); ++i) {
    add(text, ",{}", i < c.changes.size() ? fmt::format("{}", c.changes[i]) : "");
  }
  add(text, "\n");
}

std::string largestChange(const PerturbationRecord& record, const PerturbationCase& c) {
  const auto worst = largestOtherChange(record.parameters, c);
  // Of all but the offset, which is meant to move.
  if (!worst) return "-";
  const double sigmas = c.changes_sigma[*worst];
  // What two decimals would show as zero.
  if (std::abs(sigmas) < 0.005) return fmt::format("{} < 0.01 sigma", record.parameters[*worst]);
  return fmt::format("{} {:+.2f} sigma", record.parameters[*worst], sigmas);
}

void addLine(Text& text, const PerturbationRecord& record, const PerturbationCase& c) {
  const std::string what = c.kind + " " + amountText(c);
  if (!c.problem.empty()) {
    add(text, "{:<32} failed: {}\n", what, c.problem);
    return;
  }
  const OffsetFigures offset = offsetOf(record, c);
  add(text, "{:<32} {:>12} {:>10} {:>12} {:>9.4f} {:>5}  {}\n", what, fixed(offset.value_s, 1e3, 6),
      fixed(offset.std_s, 1e3, 6), fixed(offset.error_s, 1e6, 4), c.rmse_px, c.iterations,
      largestChange(record, c));
}

}  // namespace

std::string perturbationTable(const PerturbationRecord& record) {
  Text text;
  add(text,
      "#kind,amount,unit,seed,solved,rmse [px],frames,iterations,time_offset [s],"
      "time_offset_std [s],offset_error [s],problem");
  for (std::size_t i = 0; i < record.parameters.size(); ++i) {
    add(text, ",change of {} [{}]", record.parameters[i], record.units[i]);
  }
  add(text, "\n");
  addRow(text, record, record.base);
  for (const PerturbationCase& c : record.cases) addRow(text, record, c);
  return fmt::to_string(text);
}

std::string perturbationSummary(const PerturbationRecord& record) {
  Text text;
  add(text, "{:<32} {:>12} {:>10} {:>12} {:>9} {:>5}  {}\n", "", "offset [ms]", "std [ms]",
      "error [us]", "RMSE [px]", "iter.", "largest other change");
  const OffsetFigures offset = offsetOf(record, record.base);
  add(text, "{:<32} {:>12} {:>10} {:>12} {:>9.4f} {:>5}\n", "as recorded",
      fixed(offset.value_s, 1e3, 6), fixed(offset.std_s, 1e3, 6), "", record.base.rmse_px,
      record.base.iterations);
  for (const PerturbationCase& c : record.cases) addLine(text, record, c);
  add(text, "\n{}", verdictText(record.verdict));
  return fmt::to_string(text);
}

}  // namespace plumbline
