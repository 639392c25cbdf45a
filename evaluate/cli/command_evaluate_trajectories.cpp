// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "calibrator/base/error.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/estimation_options.h"
#include "evaluate/cli/runs_summary.h"
#include "evaluate/cli/trajectory_metric_options.h"
#include "evaluate/results/provenance.h"
#include "evaluate/results/result_folder.h"
#include "evaluate/trajectory/evaluate_runs.h"
#include "evaluate/trajectory/write_runs.h"

namespace plumbline {
namespace {

struct EvaluateTrajectoriesOptions {
  RunsRequest request;
  TrajectoryMetricWords metrics;
  double max_ate_m = 0;
  std::string out, body;
};

void declareEvaluateTrajectories(CLI::App& app, EvaluateTrajectoriesOptions& o) {
  app.add_option("runs", o.request.runs,
                 "Estimates, with the fields {calibration}, {sequence} and {run} in their path")
      ->required();
  app.add_option("--truth", o.request.truth, "Ground truths, with {sequence}; or one file")
      ->required();
  app.add_option("--out", o.out, "Folder for the results")->required();
  declareCoverage(app, o.metrics);
  app.add_option("--max-ate", o.max_ate_m,
                 "ATE [m] above which a run has diverged (default: the spread of the truth)")
      ->check(CLI::PositiveNumber);
  app.add_option("--body", o.body, "Rigid body of motion-capture exports");
  app.add_option("--threads", o.request.threads, "Threads (0: all cores)")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  declareTrajectoryMetrics(app, o.metrics);
}

RunsRequest evaluateTrajectoriesRequest(const EvaluateTrajectoriesOptions& o) {
  RunsRequest request = o.request;
  request.how.metrics = trajectoryMetricsFrom(o.metrics);
  request.min_coverage = o.metrics.min_coverage;
  request.how.estimate_w_first = o.metrics.estimate_w_first;
  request.how.truth_w_first = o.metrics.truth_w_first;
  request.how.read_truth.body = o.body;
  if (o.max_ate_m > 0) request.max_ate_m = o.max_ate_m;
  return request;
}

int evaluateTrajectoryRuns(const EvaluateTrajectoriesOptions& o, const CLI::App& app) {
  refuseUnwritable(o.out);
  TrajectoryRecord record = evaluateRuns(evaluateTrajectoriesRequest(o));
  record.name = std::filesystem::path(o.out).filename().string();
  record.provenance = makeProvenance("evaluate trajectories", givenOptions(app));
  record.provenance.input = std::filesystem::path(o.request.runs).filename().string();
  writeRuns(record, o.out);
  fmt::print("{}\nReport: {}/report.html\n", runsSummary(record), o.out);
  return kDone;
}

}  // namespace

Command evaluateTrajectoriesCommand() {
  return {"trajectories", "Errors of many runs, sequences and calibrations, failures counted",
          "plumbline evaluate trajectories 'results/{calibration}/{sequence}_{run}.txt' --truth "
          "'truth/{sequence}.csv' --out errors",
          [](CLI::App& app) {
            auto options = std::make_shared<EvaluateTrajectoriesOptions>();
            declareEvaluateTrajectories(app, *options);
            return std::function<int()>(
                [options, &app] { return evaluateTrajectoryRuns(*options, app); });
          }};
}

}  // namespace plumbline
