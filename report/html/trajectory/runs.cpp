// SPDX-License-Identifier: BSD-3-Clause
// What became of every run.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/statistics.h"
#include "report/html/trajectory/sections.h"

namespace plumbline::html_internal {
namespace {

std::string metres(double value) { return fmt::format("{:.4f}", value); }

Cell statusCell(const TrajectoryRun& run) {
  switch (run.status) {
    case RunStatus::kComplete:
      return {"complete", Cell::Kind::kTight, VerdictLevel::kGood};
    case RunStatus::kPartial:
      return {"partial", Cell::Kind::kTight, VerdictLevel::kDoubtful};
    case RunStatus::kFailed:
      break;
  }
  return {"failed", Cell::Kind::kTight, VerdictLevel::kBad};
}

Cell nameCell(const std::string& name) { return tight(name.empty() ? kDash : name); }

std::vector<Cell> runRow(const TrajectoryRun& run) {
  const SampleStatistics& ate = run.ate_translation_m;
  const SampleStatistics& turn = run.ate_rotation_deg;
  const bool known = ate.n > 0;
  return {nameCell(run.sequence),
          nameCell(run.calibration),
          nameCell(run.run),
          statusCell(run),
          number(fmt::format("{:.1f}", 100 * run.coverage)),
          number(known ? metres(ate.rmse) : kDash),
          number(known ? metres(ate.median) : kDash),
          number(known ? metres(ate.max) : kDash),
          number(turn.n > 0 ? fmt::format("{:.3f}", turn.rmse) : kDash),
          run.problem.empty() ? Cell{kDash} : Cell{run.problem}};
}

Table runsTable(const std::vector<TrajectoryRun>& runs) {
  Table table{{{"Sequence"},
               {"Calibration"},
               {"Run"},
               {"Status"},
               {"Covered [%]", kNumber},
               {"ATE RMSE [m]", kNumber},
               {"Median [m]", kNumber},
               {"Max [m]", kNumber},
               {"Rotation RMSE [\u00b0]", kNumber},
               {"Why not complete"}},
              {}};
  for (const TrajectoryRun& run : runs) table.rows.push_back(runRow(run));
  return withoutEmptyColumns(std::move(table));
}

/// What became of a calibration's runs.
struct Completion {
  std::size_t runs = 0, complete = 0, partial = 0, failed = 0;
  std::vector<double> rmse_m;  ///< of the complete ones
};

Completion completionOf(const std::vector<TrajectoryRun>& runs, const std::string& calibration) {
  Completion c;
  for (const TrajectoryRun& run : runs) {
    if (run.calibration != calibration) continue;
    ++c.runs;
    if (run.status == RunStatus::kPartial) ++c.partial;
    if (run.status == RunStatus::kFailed) ++c.failed;
    if (run.status != RunStatus::kComplete) continue;
    ++c.complete;
    if (run.ate_translation_m.n > 0) c.rmse_m.push_back(run.ate_translation_m.rmse);
  }
  return c;
}

VerdictLevel levelOf(const Completion& c) {
  if (c.failed > 0) return VerdictLevel::kBad;
  return c.partial > 0 ? VerdictLevel::kDoubtful : VerdictLevel::kGood;
}

Table completionTable(const std::vector<TrajectoryRun>& runs) {
  Table table{{{"Calibration"},
               {"Completed"},
               {"Partial", kNumber},
               {"Failed", kNumber},
               {"Median ATE RMSE of complete runs [m]", kNumber}},
              {}};
  for (const std::string& name : calibrationsOf(runs)) {
    const Completion c = completionOf(runs, name);
    table.rows.push_back(
        {{name.empty() ? kDash : name},
         {fmt::format("{} of {}", c.complete, c.runs), Cell::Kind::kText, levelOf(c)},
         number(std::to_string(c.partial)),
         number(std::to_string(c.failed)),
         number(c.rmse_m.empty() ? kDash : metres(quantile(c.rmse_m, 0.5)))});
  }
  return withoutEmptyColumns(std::move(table));
}

constexpr std::size_t kNamed = 4;  // runs that share a remark and are named

/// Each remark once, with the runs that it is about.
Table remarksTable(const std::vector<TrajectoryRun>& runs) {
  std::vector<std::pair<std::string, std::vector<std::string>>> remarks;
  for (const TrajectoryRun& run : runs) {
    for (const std::string& text : run.remarks) {
      auto known = std::find_if(remarks.begin(), remarks.end(),
                                [&](const auto& remark) { return remark.first == text; });
      if (known == remarks.end()) known = remarks.insert(remarks.end(), {text, {}});
      known->second.push_back(runName(run));
    }
  }
  Table table{{{"Remark"}, {"Runs"}}, {}};
  for (const auto& [text, names] : remarks) {
    std::string list;
    for (std::size_t i = 0; i < std::min(names.size(), kNamed); ++i) {
      list += (i > 0 ? ", " : "") + names[i];
    }
    if (names.size() > kNamed) list += fmt::format(" and {} more", names.size() - kNamed);
    table.rows.push_back({{text}, {list}});
  }
  return table;
}

Card oneRunCard(const TrajectoryRun& run) {
  return {"ATE RMSE", run.ate_translation_m.n > 0 ? metres(run.ate_translation_m.rmse) : kDash, "m",
          fmt::format("{}, {:.1f} % of the truth's time",
                      run.status == RunStatus::kComplete  ? "complete"
                      : run.status == RunStatus::kPartial ? "partial"
                                                          : "failed",
                      100 * run.coverage)};
}

}  // namespace

std::vector<Card> trajectoryCards(const std::vector<TrajectoryRun>& runs) {
  std::vector<Card> cards;
  for (const std::string& name : calibrationsOf(runs)) {
    const Completion c = completionOf(runs, name);
    if (runs.size() == 1) return {oneRunCard(runs.front())};
    cards.push_back({"ATE, " + (name.empty() ? std::string("all runs") : name),
                     c.rmse_m.empty() ? kDash : metres(quantile(c.rmse_m, 0.5)), "m",
                     fmt::format("median RMSE of complete runs; {} of {} complete, {} partial, {} "
                                 "failed",
                                 c.complete, c.runs, c.partial, c.failed)});
  }
  return cards;
}

Section runsSection(const std::vector<TrajectoryRun>& runs) {
  Section section{"runs",
                  runs.size() > 1 ? "Runs" : "Run",
                  runs.size() > 1 ? "Every run counts: those that failed or cover only a part of "
                                    "the truth's span stay in the table and in the completion, "
                                    "whatever the errors of the others."
                                  : "",
                  {},
                  {}};
  if (runs.empty()) return section;
  if (runs.size() > 1) {
    section.blocks.push_back({"Completion", "", completionTable(runs), {}, {}});
  }
  section.blocks.push_back(
      {runs.size() > 1 ? "All runs" : "",
       "ATE is the distance between the aligned estimate and the truth at paired stamps.",
       runsTable(runs),
       {},
       {}});
  if (Table remarks = remarksTable(runs); !remarks.rows.empty()) {
    section.blocks.push_back({"Remarks", "", std::move(remarks), {}, {}});
  }
  return section;
}

}  // namespace plumbline::html_internal
