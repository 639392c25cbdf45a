// SPDX-License-Identifier: BSD-3-Clause
// What became of every run.
#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "report/html/trajectory/sections.h"

namespace plumbline::html_internal {
namespace {

std::string metres(double value) { return fmt::format("{:.4f}", value); }

Cell statusCell(const TrajectoryRun& run) {
  const VerdictLevel level = run.status == RunStatus::kComplete  ? VerdictLevel::kGood
                             : run.status == RunStatus::kPartial ? VerdictLevel::kCaution
                                                                 : VerdictLevel::kBad;
  return {toString(run.status), Cell::Kind::kTight, level};
}

Cell nameCell(const std::string& name) { return tight(name.empty() ? kDash : name); }

// Without the coverage of a run that failed: it would be that of whatever the run wrote before. One
// without ground truth has none.
std::vector<Cell> runRow(const TrajectoryRun& run) {
  const SampleStatistics& ate = run.ate_translation_m;
  const SampleStatistics& turn = run.ate_rotation_deg;
  const bool known = ate.n > 0;
  const bool covers = run.status != RunStatus::kFailed && !run.without_truth;
  return {nameCell(run.sequence),
          nameCell(run.calibration),
          nameCell(run.run),
          statusCell(run),
          number(covers ? fmt::format("{:.1f}", 100 * run.coverage) : kDash),
          number(known ? metres(ate.rmse) : kDash),
          number(known ? metres(ate.median) : kDash),
          number(known ? metres(ate.max) : kDash),
          number(turn.n > 0 ? fmt::format("{:.3f}", turn.rmse) : kDash),
          run.problem.empty() ? Cell{kDash} : Cell{run.problem}};
}

Table runsTable(const std::vector<TrajectoryRun>& runs) {
  Table table{{words("Sequence"), words("Calibration"), words("Run"), words("Status"),
               number("Covered [%]"), number("ATE RMSE [m]"), number("Median [m]"),
               number("Max [m]"), number("Rotation RMSE [\u00b0]"), words("Reason")}};
  for (const TrajectoryRun& run : runs) table.rows.push_back(runRow(run));
  return withoutEmptyColumns(std::move(table));
}

std::string medianText(const RunsSummary& s) {
  return s.ate_median_m ? metres(*s.ate_median_m) : kDash;
}

Table completionTable(const TrajectoryStudy& study) {
  Table table{{words("Calibration"), words("Completed"), number("Partial"), number("Failed"),
               number("Median ATE RMSE [m]")}};
  for (const RunsSummary& s : overAll(study)) {
    table.rows.push_back(
        {{s.calibration.empty() ? kDash : s.calibration},
         {fmt::format("{} of {}", s.complete, s.expected), Cell::Kind::kText, s.level},
         number(s.partial),
         number(s.failed),
         number(medianText(s))});
  }
  return withoutEmptyColumns(std::move(table));
}

/// Sequences by calibrations; the smallest median of a row of several is set off.
Table sequencesTable(const TrajectoryStudy& study) {
  const std::vector<std::string> calibrations = calibrationsOf(study.runs);
  Table table{{words("Sequence")}};
  for (const std::string& c : calibrations) table.columns.push_back(number(c + " [m]"));
  for (const std::string& sequence : sequencesOf(study.runs)) {
    std::vector<std::optional<double>> medians;
    double least = std::numeric_limits<double>::infinity();
    for (const std::string& c : calibrations) {
      const auto found = std::ranges::find_if(study.summary, [&](const RunsSummary& s) {
        return s.sequence == sequence && s.calibration == c;
      });
      medians.push_back(found == study.summary.end() ? std::nullopt : found->ate_median_m);
      least = std::min(least, medians.back().value_or(least));
    }
    std::vector<Cell> row{nameCell(sequence)};
    for (const std::optional<double>& m : medians) {
      row.push_back(number(m ? metres(*m) : kDash));
      row.back().best = m && *m == least;
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

constexpr std::size_t kNamed = 4;  // runs that share a remark and are named

/// Each remark once, with the runs that it is about.
Table remarksTable(const std::vector<TrajectoryRun>& runs) {
  std::vector<std::pair<std::string, std::vector<std::string>>> remarks;
  for (const TrajectoryRun& run : runs) {
    // What was left out, and why, is a remark too.
    std::vector<std::string> texts = run.remarks;
    if (!run.left_out.empty()) texts.push_back(run.left_out);
    for (const std::string& text : texts) {
      auto known =
          std::ranges::find(remarks, text, [](const auto& remark) { return remark.first; });
      if (known == remarks.end()) known = remarks.insert(remarks.end(), {text, {}});
      known->second.push_back(runName(run));
    }
  }
  Table table{{words("Remark"), words("Runs")}};
  for (const auto& [text, names] : remarks) {
    const auto shown = static_cast<std::ptrdiff_t>(std::min(names.size(), kNamed));
    std::string list = fmt::format("{}", fmt::join(names.begin(), names.begin() + shown, ", "));
    if (names.size() > kNamed) list += fmt::format(" and {} more", names.size() - kNamed);
    table.rows.push_back({{typeset(text)}, {list}});
  }
  return table;
}

/// What stands under a single run's error, which says little of a run that lost its way.
std::string coverageText(const TrajectoryRun& run) {
  if (run.status == RunStatus::kFailed) return "failed";
  if (run.without_truth) return std::string(toString(run.status)) + ", no ground truth";
  return fmt::format("{}, {:.1f} % of the truth's time", toString(run.status), 100 * run.coverage);
}

Card oneRunCard(const TrajectoryRun& run) {
  return {"ATE RMSE", run.ate_translation_m.n > 0 ? metres(run.ate_translation_m.rmse) : kDash, "m",
          coverageText(run)};
}

}  // namespace

std::vector<Card> trajectoryCards(const TrajectoryStudy& study) {
  if (study.runs.size() == 1) return {oneRunCard(study.runs.front())};
  std::vector<Card> cards;
  for (const RunsSummary& s : overAll(study)) {
    cards.push_back({"ATE, " + (s.calibration.empty() ? std::string("all runs") : s.calibration),
                     medianText(s), s.ate_median_m ? "m" : "",
                     fmt::format("median RMSE; {} of {} complete, {} partial, {} failed",
                                 s.complete, s.expected, s.partial, s.failed)});
  }
  return cards;
}

Section runsSection(const TrajectoryStudy& study) {
  const std::vector<TrajectoryRun>& runs = study.runs;
  Section section{"runs", runs.size() > 1 ? "Runs" : "Run",
                  runs.size() > 1 ? "Every run counts: those that failed or cover only a part of "
                                    "the truth's span are listed and counted in the completion."
                                  : ""};
  if (runs.empty()) return section;
  if (runs.size() > 1) {
    section.blocks.push_back(
        {"Completion",
         "In the median a run that is not complete counts as larger than any; none where half or "
         "more of those with a ground truth are not.",
         completionTable(study)});
  }
  if (calibrationsOf(runs).size() > 1) {
    section.blocks.push_back({"Sequences and calibrations",
                              "Median ATE RMSE, as above; the smallest of a sequence is bold, even "
                              "if it is not significant (paired differences, below).",
                              sequencesTable(study)});
  }
  section.blocks.push_back(
      {runs.size() > 1 ? "All runs" : "",
       "ATE is the distance between the aligned estimate and the truth at paired stamps.",
       runsTable(runs)});
  return withTable(std::move(section), remarksTable(runs), "Remarks");
}

}  // namespace plumbline::html_internal
