// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/trajectory/runs_document.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "calibrator/base/statistics.h"
#include "evaluate/results/json_values.h"
#include "evaluate/results/record_json.h"
#include "evaluate/trajectory/trajectory_document.h"
#include "report/records/paired_differences.h"

namespace plumbline {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> inOrder(const std::vector<TrajectoryRun>& runs,
                                 std::string TrajectoryRun::*field) {
  std::vector<std::string> names;
  for (const TrajectoryRun& run : runs) {
    if (std::find(names.begin(), names.end(), run.*field) == names.end()) {
      names.push_back(run.*field);
    }
  }
  return names;
}

std::optional<double> medianOf(std::vector<double> complete, std::size_t expected) {
  complete.resize(expected, std::numeric_limits<double>::infinity());
  if (expected == 0) return std::nullopt;
  const double median = quantile(std::move(complete), 0.5);
  return std::isfinite(median) ? std::optional(median) : std::nullopt;
}

// Of one sequence, or of all where there is none.
RunsSummary summaryOf(const std::vector<TrajectoryRun>& runs, const std::string* sequence,
                      const std::string& calibration) {
  RunsSummary s;
  s.sequence = sequence != nullptr ? *sequence : "";
  s.calibration = calibration;
  std::vector<double> ate;
  for (const TrajectoryRun& run : runs) {
    if (run.calibration != calibration) continue;
    if (sequence != nullptr && run.sequence != *sequence) continue;
    ++s.expected;
    if (run.status == RunStatus::kPartial) ++s.partial;
    if (run.status == RunStatus::kFailed) ++s.failed;
    if (run.status == RunStatus::kComplete) ate.push_back(run.ate_translation_m.rmse);
  }
  s.complete = ate.size();
  if (s.expected > 0) {
    s.completion = static_cast<double>(s.complete) / static_cast<double>(s.expected);
  }
  s.ate_median_m = medianOf(std::move(ate), s.expected);
  return s;
}

Json summaryJson(const RunsSummary& s) {
  return {{"sequence", s.sequence.empty() ? Json() : Json(s.sequence)},
          {"calibration", s.calibration},
          {"expected", s.expected},
          {"complete", s.complete},
          {"partial", s.partial},
          {"failed", s.failed},
          {"completion", s.completion},
          {"ate_median_m", optionalJson(s.ate_median_m)}};
}

Json differenceJson(const PairedDifference& d) {
  Json json{{"a", d.a},           {"b", d.b},
            {"pairs", d.pairs},   {"left_out", d.left_out},
            {"mean_m", d.mean_m}, {"median_m", d.median_m},
            {"std_m", d.std_m},   {"b_better", d.b_better},
            {"ties", d.ties},     {"sign_test_p", d.sign_test_p}};
  if (d.low_m && d.high_m) json["mean_interval_m"] = {*d.low_m, *d.high_m};
  return json;
}

Json runJson(const TrajectoryRun& run) {
  Json json = {{"sequence", run.sequence},
               {"calibration", run.calibration},
               {"run", run.run},
               {"status", nameOf(run.status)},
               {"problem", run.problem}};
  json.update(trajectoryRunJson(run));
  return json;
}

std::string rowOf(const TrajectoryRun& run) {
  std::string text =
      fmt::format("{},{},{},{},{:.6f},", csvCell(run.sequence), csvCell(run.calibration),
                  csvCell(run.run), nameOf(run.status), run.coverage);
  if (run.ate_translation_m.n > 0) {
    text +=
        fmt::format("{},{:.9g},{:.9g},{:.9g},", run.ate_translation_m.n, run.ate_translation_m.rmse,
                    run.ate_translation_m.median, run.ate_translation_m.max);
  } else {
    text += ",,,,";
  }
  if (run.ate_rotation_deg.n > 0) text += fmt::format("{:.9g}", run.ate_rotation_deg.rmse);
  return text + "," + csvCell(run.problem) + "," + csvCell(run.estimate) + "\n";
}

}  // namespace

const char* nameOf(RunStatus status) {
  switch (status) {
    case RunStatus::kComplete:
      return "complete";
    case RunStatus::kPartial:
      return "partial";
    case RunStatus::kFailed:
      return "failed";
  }
  return "";
}

std::vector<RunsSummary> summarised(const std::vector<TrajectoryRun>& runs) {
  std::vector<RunsSummary> list;
  const auto sequences = inOrder(runs, &TrajectoryRun::sequence);
  const auto calibrations = inOrder(runs, &TrajectoryRun::calibration);
  for (const std::string& sequence : sequences) {
    for (const std::string& name : calibrations) list.push_back(summaryOf(runs, &sequence, name));
  }
  if (sequences.size() < 2) return list;
  for (const std::string& name : calibrations) list.push_back(summaryOf(runs, nullptr, name));
  return list;
}

std::string runsDocument(const TrajectoryRecord& record) {
  Json json = {{"schema", 1}, {"name", record.name}, {"summary", Json::array()}};
  json["paired"] = Json::array();
  json["runs"] = Json::array();
  for (const RunsSummary& s : summarised(record.runs)) json["summary"].push_back(summaryJson(s));
  for (const PairedDifference& d : pairedDifferences(record.runs)) {
    json["paired"].push_back(differenceJson(d));
  }
  for (const TrajectoryRun& run : record.runs) json["runs"].push_back(runJson(run));
  json["provenance"] = provenanceJson(record.provenance);
  return json.dump(2) + "\n";
}

std::string runsTable(const TrajectoryRecord& record) {
  std::string text =
      "sequence,calibration,run,status,coverage,n,ate_rmse_m,ate_median_m,ate_max_m,"
      "ate_rotation_rmse_deg,problem,estimate\n";
  for (const TrajectoryRun& run : record.runs) text += rowOf(run);
  return text;
}

}  // namespace plumbline
