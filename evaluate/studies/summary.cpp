// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "evaluate/metrics/headline.h"
#include "evaluate/results/text.h"
#include "evaluate/studies/perturbation.h"
#include "evaluate/studies/perturbation_study.h"

namespace plumbline {
namespace {

void addRow(Text& text, const PerturbationCase& c, std::size_t parameters) {
  add(text, "{},{},{},{},{},{},{},{},{},{},{},{}", c.kind, c.amount, c.unit, c.seed,
      c.problem.empty() ? "yes" : "no", c.rmse_px, c.frames, c.iterations, c.time_offset_s,
      c.time_offset_std_s.value_or(0), c.offset_error_s, csvCell(c.problem));
  for (std::size_t i = 0; i < parameters; ++i) {
    add(text, ",{}", i < c.changes.size() ? fmt::format("{}", c.changes[i]) : "");
  }
  add(text, "\n");
}

std::string largestChange(const PerturbationRecord& record, const PerturbationCase& c) {
  const auto worst = largestOtherChange(record.parameters, c);
  if (!worst) return "-";
  const double sigmas = c.changes_sigma[*worst];
  // What two decimals would show as zero.
  if (std::abs(sigmas) < 0.005) return fmt::format("{} < 0.01 sigma", record.parameters[*worst]);
  return fmt::format("{} {:+.2f} sigma", record.parameters[*worst], sigmas);
}

void addLine(Text& text, const PerturbationRecord& record, const PerturbationCase& c) {
  const std::string what = fmt::format("{} {:+g} {}", c.kind, c.amount, c.unit);
  if (!c.problem.empty()) {
    add(text, "{:<32} failed: {}\n", what, c.problem);
    return;
  }
  add(text, "{:<32} {:>12.6f} {:>10.6f} {:>12.4f} {:>9.4f} {:>5}  {}\n", what,
      1e3 * c.time_offset_s, 1e3 * c.time_offset_std_s.value_or(0), 1e6 * c.offset_error_s,
      c.rmse_px, c.iterations, largestChange(record, c));
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
  addRow(text, record.base, record.parameters.size());
  for (const PerturbationCase& c : record.cases) addRow(text, c, record.parameters.size());
  return fmt::to_string(text);
}

std::string perturbationSummary(const PerturbationRecord& record) {
  Text text;
  add(text, "{:<32} {:>12} {:>10} {:>12} {:>9} {:>5}  {}\n", "", "offset [ms]", "std [ms]",
      "error [us]", "RMSE [px]", "iter.", "largest other change");
  PerturbationCase base = record.base;
  add(text, "{:<32} {:>12.6f} {:>10.6f} {:>12} {:>9.4f} {:>5}\n", "as recorded",
      1e3 * base.time_offset_s, 1e3 * base.time_offset_std_s.value_or(0), "", base.rmse_px,
      base.iterations);
  for (const PerturbationCase& c : record.cases) addLine(text, record, c);
  add(text, "\n{}", verdictText(record.verdict));
  return fmt::to_string(text);
}

}  // namespace plumbline
