// SPDX-License-Identifier: BSD-3-Clause
// `plumbline evaluate`, and its subcommands for trajectories.
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "evaluate/cli/commands.h"
#include "evaluate/cli/options/option_values.h"
#include "evaluate/cli/options/result_options.h"
#include "evaluate/cli/options/shared_options.h"
#include "evaluate/cli/options/trajectory_metric_options.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/metrics/headline.h"
#include "evaluate/metrics/lists.h"
#include "evaluate/metrics/trajectory/verdict.h"
#include "evaluate/results/provenance.h"
#include "evaluate/results/result_folder.h"
#include "evaluate/trajectory/evaluate_runs.h"
#include "evaluate/trajectory/evaluate_trajectory.h"
#include "evaluate/trajectory/summary.h"
#include "report/html/pages.h"
#include "report/records/documents.h"

namespace plumbline {
namespace {

struct EvaluateTrajectoryOptions {
  std::string estimate, truth;
  std::string estimate_format, format, estimate_times, truth_times;
  TrajectoryMetricWords metrics;
  JsonOption json;
  OutputOptions output;
  bool no_report = false;
  FailOnOption fail_on;
};

void declareEvaluateTrajectory(CLI::App& app, EvaluateTrajectoryOptions& o) {
  app.add_option("estimate", o.estimate,
                 "Estimated trajectory: TUM, EuRoC or KITTI; - for standard input")
      ->required();
  app.add_option("truth", o.truth, "Ground truth: TUM, EuRoC, KITTI, Motive's or Vicon's CSV")
      ->required();
  app.add_option("--format", o.format,
                 "Format of the truth: tum, euroc, kitti, motive, vicon (default: by content)");
  app.add_option("--estimate-format", o.estimate_format, "Format of the estimate, as --format");
  app.add_option("--estimate-times", o.estimate_times,
                 "KITTI's times.txt of the estimate [s] (without it one frame per second)");
  app.add_option("--truth-times", o.truth_times, "KITTI's times.txt of the truth");
  app.add_option("--body", o.metrics.request.read_truth.body,
                 "Rigid body of a motion-capture export");
  o.json.declare(app);
  o.output.declare(app, "Folder for the report, the figures and the records");
  declareNoReport(app, o.no_report);
  app.get_option("--no-report")->needs(app.get_option("--out"));
  o.fail_on.declare(app);
  declareTrajectoryMetrics(app, o.metrics);
  declareCoverage(app, o.metrics);
}

TrajectoryRequest evaluateTrajectoryRequest(const EvaluateTrajectoryOptions& o) {
  TrajectoryRequest request = judgedAs(o.metrics);
  request.estimate = o.estimate;
  request.truth = o.truth;
  const auto format = [](const char* option, const std::string& word) {
    return word.empty() ? std::nullopt : std::optional(enumValue<TrajectoryFormat>(option, word));
  };
  request.read_truth.format = format("--format", o.format);
  request.read_estimate.format = format("--estimate-format", o.estimate_format);
  request.read_estimate.times = o.estimate_times;
  request.read_truth.times = o.truth_times;
  return request;
}

/// What is read: no output may replace it, and it is hashed (no hash where - is among them).
std::vector<std::string> trajectoryInputs(const EvaluateTrajectoryOptions& o) {
  std::vector<std::string> inputs{o.estimate, o.truth};
  append(inputs, givenInputs({o.estimate_times, o.truth_times}));
  return inputs;
}

Provenance provenanceOf(const EvaluateTrajectoryOptions& o, const CLI::App& app) {
  auto given = givenOptions(app);
  // They are the input, which is named by file names alone: results do not depend on where files
  // lie.
  std::erase_if(given, [](const auto& option) {
    return option.first == "estimate" || option.first == "truth";
  });
  Provenance provenance = makeProvenance("evaluate trajectory", std::move(given));
  provenance.input =
      fmt::format("{} against {}", std::filesystem::path(o.estimate).filename().string(),
                  std::filesystem::path(o.truth).filename().string());
  provenance.input_hash = inputFilesHash(trajectoryInputs(o));
  return provenance;
}

/// As a study of one run, so that limits, verdict, store and page are those of many.
TrajectoryRecord judged(const TrajectoryRun& run, const EvaluateTrajectoryOptions& o,
                        const CLI::App& app) {
  RunsRequest limits;
  setLimits(o.metrics, limits);
  TrajectoryRecord record = studyOfOne(run, limits);
  record.verdict = trajectoryVerdict(record);
  record.provenance = provenanceOf(o, app);
  return record;
}

int evaluateTrajectoryFiles(const EvaluateTrajectoryOptions& o, const CLI::App& app) {
  const TrajectoryRequest request = evaluateTrajectoryRequest(o);
  const std::vector<std::string> inputs = trajectoryInputs(o);
  std::optional<OutputFolder> out;
  if (app.get_option("--out")->count() > 0) {
    out.emplace(o.output.request("errors of trajectories", inputs));
  }
  std::optional<OutputFile> json = o.json.reserve(o.output, inputs, o.output.out, kTrajectoryMark);
  const Result<TrajectoryRun> result = evaluateTrajectory(request);
  if (!result) return tellFailure(result.failure(), app);
  const TrajectoryRecord record = judged(*result, o, app);
  const VerdictLevel level = record.verdict.level;
  if (out) {
    // Empty: no page is written.
    std::function<std::string(const TrajectoryRecord&)> page;
    if (!o.no_report) page = renderTrajectoryPage;
    writeResults(*out, record,
                 {{"trajectory.json", documentOf(record)}, {"trajectory.csv", runsTable(record)}},
                 page);
  }
  // --json has the figures of the run at its top; trajectory.json of the folder is the document of
  // a study, whatever its number of runs.
  const SingleTrajectory single{record.runs[0], record.verdict, record.provenance};
  if (json) json->write(documentOf(single));
  if (o.json.piped()) {
    writeDocument(documentOf(single));
    return o.fail_on.exitCode(level);
  }
  std::string summary = trajectorySummary(*result);
  // Without a finding the verdict would repeat the figures.
  if (level != VerdictLevel::kGood) summary += "\n" + verdictText(record.verdict, kCompleteWord);
  saySummary(summary);
  if (json) say("\nFigures: {}\n", *o.json.file);
  if (out && !o.no_report) say("\nReport: {}/{}\n", o.output.out, kPageFile);
  if (out && o.no_report) say("\nResult: {}/trajectory.json\n", o.output.out);
  return o.fail_on.exitCode(level);
}

struct EvaluateTrajectoriesOptions {
  RunsRequest request;
  TrajectoryMetricWords metrics;
  ResultOptions output;
};

void declareEvaluateTrajectories(CLI::App& app, EvaluateTrajectoriesOptions& o) {
  app.add_option("runs", o.request.runs,
                 "Estimates, with the fields {calibration}, {sequence} and {run} in their path")
      ->required();
  app.add_option("--truth", o.request.truth, "Ground truths, with {sequence}; or one file")
      ->required();
  o.output.declareResult(app);
  declareCoverage(app, o.metrics);
  app.add_option("--body", o.metrics.request.read_truth.body,
                 "Rigid body of motion-capture exports");
  addWithDefault(app, "--threads", o.request.threads, "Threads (0: all cores)")
      ->check(numberFrom(0));
  declareTrajectoryMetrics(app, o.metrics);
}

RunsRequest evaluateTrajectoriesRequest(const EvaluateTrajectoriesOptions& o) {
  RunsRequest request = o.request;
  request.how = judgedAs(o.metrics);
  setLimits(o.metrics, request);
  return request;
}

int evaluateTrajectoryRuns(const EvaluateTrajectoriesOptions& o, const CLI::App& app) {
  const RunsRequest request = evaluateTrajectoriesRequest(o);
  // As the patterns match now: results must not be written over what matches.
  std::vector<std::string> inputs = filesOf(request.runs);
  append(inputs, filesOf(request.truth));
  ResultWriter out(o.output, o.output.request("errors of trajectories", inputs));
  TrajectoryRecord record = evaluateRuns(request);
  record.verdict = trajectoryVerdict(record);
  record.name = out.name();
  record.provenance = makeProvenance("evaluate trajectories", givenOptions(app));
  record.provenance.input = std::filesystem::path(o.request.runs).filename().string();
  record.provenance.input_hash = inputFilesHash(inputs);
  return out.finish(
      record, {{"trajectory.json", documentOf(record)}, {"trajectory.csv", runsTable(record)}},
      renderTrajectoryPage,
      runsSummary(record) + "\n" + verdictText(record.verdict, kCompleteWord));
}

Command evaluateTrajectoryCommand() {
  return {"trajectory", "Errors of an estimated trajectory against ground truth",
          "plumbline evaluate trajectory estimate.txt groundtruth.csv --align se3 --rpe 1m,10m",
          withOptions(declareEvaluateTrajectory, evaluateTrajectoryFiles)};
}

Command evaluateTrajectoriesCommand() {
  return {"trajectories", "Errors of many runs, sequences and calibrations, failures counted",
          "plumbline evaluate trajectories 'results/{calibration}/{sequence}_{run}.txt' --truth "
          "'truth/{sequence}.csv' --out errors",
          withOptions(declareEvaluateTrajectories, evaluateTrajectoryRuns)};
}

}  // namespace

Command evaluateCommand() {
  return {"evaluate", "Evaluate calibrations on sessions, and trajectories against ground truth",
          "plumbline evaluate trajectory estimate.txt groundtruth.csv", [](CLI::App& app) {
            app.require_subcommand(1);
            return addCommands(app, {evaluateTrajectoryCommand(), evaluateTrajectoriesCommand(),
                                     evaluateCalibrationCommand()});
          }};
}

}  // namespace plumbline
