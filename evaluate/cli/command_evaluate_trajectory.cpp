// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "calibrator/base/error.h"
#include "datasets/files/file_io.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/option_values.h"
#include "evaluate/cli/session_options.h"
#include "evaluate/cli/trajectory_metric_options.h"
#include "evaluate/results/provenance.h"
#include "evaluate/results/result_folder.h"
#include "evaluate/trajectory/evaluate_runs.h"
#include "evaluate/trajectory/evaluate_trajectory.h"
#include "evaluate/trajectory/summary.h"
#include "report/html/trajectory/page.h"
#include "report/records/documents.h"

namespace plumbline {
namespace {

struct EvaluateTrajectoryOptions {
  std::string estimate, truth;
  std::string body, estimate_format, format;
  TrajectoryMetricWords metrics;
  std::optional<std::string> json, out;
};

void declareFiles(CLI::App& app, EvaluateTrajectoryOptions& o) {
  app.add_option("estimate", o.estimate, "Estimated trajectory: TUM, EuRoC or KITTI")->required();
  app.add_option("truth", o.truth, "Ground truth: TUM, EuRoC, KITTI, Motive's or Vicon's CSV")
      ->required();
  app.add_option("--format", o.format,
                 "Format of the truth: tum, euroc, kitti, motive, vicon (default: by content)");
  app.add_option("--estimate-format", o.estimate_format, "Format of the estimate, as --format");
  app.add_option("--body", o.body, "Rigid body of a motion-capture export");
  app.add_option("--json", o.json, "File to write the figures to; - for standard output");
  app.add_option("--out", o.out, "Folder for the report, the figures and the records");
}

TrajectoryRequest evaluateTrajectoryRequest(const EvaluateTrajectoryOptions& o) {
  TrajectoryRequest request;
  request.estimate = o.estimate;
  request.truth = o.truth;
  request.metrics = trajectoryMetricsFrom(o.metrics);
  request.estimate_w_first = o.metrics.estimate_w_first;
  request.truth_w_first = o.metrics.truth_w_first;
  if (!o.format.empty()) request.read_truth.format = trajectoryFormatFrom(o.format);
  if (!o.estimate_format.empty()) {
    request.read_estimate.format = trajectoryFormatFrom(o.estimate_format);
  }
  request.read_truth.body = o.body;
  return request;
}

void writeStudy(const TrajectoryEvaluation& evaluation, const EvaluateTrajectoryOptions& o,
                const CLI::App& app) {
  TrajectoryRecord record = studyOfOne(evaluation.run, o.metrics.min_coverage);
  auto given = givenOptions(app);
  std::erase_if(given, [](const auto& option) {
    return option.first == "estimate" || option.first == "truth" || option.first == "--json";
  });
  record.provenance = makeProvenance("evaluate trajectory", std::move(given));
  record.provenance.input =
      fmt::format("{} against {}", std::filesystem::path(o.estimate).filename().string(),
                  std::filesystem::path(o.truth).filename().string());
  writeResults(*o.out, record,
               {{"trajectory.json", documentOf(record)}, {"trajectory.csv", runsTable(record)}},
               renderTrajectoryPage(record));
}

int evaluateTrajectoryFiles(const EvaluateTrajectoryOptions& o, const CLI::App& app) {
  if (o.out) refuseUnwritable(*o.out);
  const Result<TrajectoryEvaluation> result = evaluateTrajectory(evaluateTrajectoryRequest(o));
  if (!result) return tellFailure(result.failure());
  if (o.out) writeStudy(*result, o, app);
  if (o.json == kStandardOutput) {
    fmt::print("{}", documentOf(result->run));
    return kDone;
  }
  fmt::print("{}", trajectorySummary(*result));
  if (o.json) {
    writeFileAtomically(*o.json, documentOf(result->run));
    fmt::print("\nFigures: {}\n", *o.json);
  }
  if (o.out) fmt::print("\nReport: {}/report.html\n", *o.out);
  return kDone;
}

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
                 "ATE [m] above which a run has diverged (default: what never moving would reach)")
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
  writeResults(o.out, record,
               {{"trajectory.json", documentOf(record)}, {"trajectory.csv", runsTable(record)}},
               renderTrajectoryPage(record));
  fmt::print("{}\nReport: {}/report.html\n", runsSummary(record), o.out);
  return kDone;
}

}  // namespace

Command evaluateTrajectoryCommand() {
  return {"trajectory", "Errors of an estimated trajectory against ground truth",
          "plumbline evaluate trajectory estimate.txt groundtruth.csv --align se3 --rpe 1m,10m",
          [](CLI::App& app) {
            auto options = std::make_shared<EvaluateTrajectoryOptions>();
            declareFiles(app, *options);
            declareTrajectoryMetrics(app, options->metrics);
            declareCoverage(app, options->metrics);
            return std::function<int()>(
                [options, &app] { return evaluateTrajectoryFiles(*options, app); });
          }};
}

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
