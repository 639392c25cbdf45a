// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/runs_summary.h"

#include <fmt/format.h>

#include "evaluate/trajectory/runs_document.h"
#include "report/records/paired_differences.h"

namespace plumbline {
namespace {

std::string nameOr(const std::string& name, const char* otherwise) {
  return name.empty() ? otherwise : name;
}

std::string summaryTable(const TrajectoryRecord& record) {
  std::string text = fmt::format("{:<16}{:<24}{:>10}{:>9}{:>8}{:>18}\n", "sequence", "calibration",
                                 "complete", "partial", "failed", "median ATE [m]");
  for (const RunsSummary& s : summarised(record.runs)) {
    const std::string ate = s.ate_median_m ? fmt::format("{:.4f}", *s.ate_median_m) : "-";
    text += fmt::format("{:<16}{:<24}{:>10}{:>9}{:>8}{:>18}\n", nameOr(s.sequence, "all"),
                        nameOr(s.calibration, "-"), fmt::format("{}/{}", s.complete, s.expected),
                        s.partial, s.failed, ate);
  }
  return text;
}

std::string differenceLines(const TrajectoryRecord& record) {
  std::string text;
  for (const PairedDifference& d : pairedDifferences(record.runs)) {
    if (d.pairs == 0) {
      text += fmt::format("{} - {}: no sequence and run that both completed\n", d.b, d.a);
      continue;
    }
    text += fmt::format(
        "{} - {}: ATE {:+.4f} m (mean of {} pairs, median {:+.4f}, std {:.4f}); lower in {}; {} "
        "left out\n",
        d.b, d.a, d.mean_m, d.pairs, d.median_m, d.std_m, d.b_better, d.left_out);
  }
  return text;
}

std::string problemLines(const TrajectoryRecord& record) {
  std::string text;
  for (const TrajectoryRun& run : record.runs) {
    if (run.status == RunStatus::kComplete) continue;
    text += fmt::format("{}: {} {} run {}: {}\n", nameOf(run.status), nameOr(run.sequence, "-"),
                        nameOr(run.calibration, "-"), nameOr(run.run, "-"), run.problem);
  }
  return text;
}

}  // namespace

std::string runsSummary(const TrajectoryRecord& record) {
  const std::string paired = differenceLines(record), problems = problemLines(record);
  std::string text = summaryTable(record);
  if (!paired.empty()) text += "\n" + paired;
  if (!problems.empty()) text += "\n" + problems;
  return text;
}

}  // namespace plumbline
