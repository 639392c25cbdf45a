// SPDX-License-Identifier: BSD-3-Clause
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/options/option_lists.h"
#include "evaluate/cli/options/option_values.h"
#include "evaluate/cli/options/result_options.h"
#include "evaluate/cli/options/session_options.h"
#include "evaluate/cli/options/shared_options.h"
#include "evaluate/cli/options/trajectory_metric_options.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/compare/compare_calibrations.h"
#include "evaluate/metrics/lists.h"
#include "evaluate/metrics/trajectory/verdict.h"
#include "evaluate/metrics/verdict.h"
#include "evaluate/results/progress.h"
#include "evaluate/results/provenance.h"
#include "evaluate/results/result_folder.h"
#include "evaluate/trajectory/evaluate_runs.h"
#include "evaluate/trajectory/summary.h"
#include "report/html/pages.h"
#include "report/records/documents.h"

namespace plumbline {
namespace {

struct CompareOptions {
  // Both ranges, since at infinity only a rotation can make up for other intrinsics, near by a
  // translation as well.
  std::vector<std::string> ranges{"inf", "1"};
  CompareRequest request;  ///< what is no word
  SessionOptions session;
  ResultOptions output;
  std::string grid = "31x21";
  std::string uncertainty = "cross-reprojection";
  std::string fit = "squares";
  bool no_session_estimate = false;
  MeasurementOptions measurements;
  RunsRequest runs;  // trajectories that were estimated with these calibrations
  TrajectoryMetricWords metrics;
};

void declareMaps(CLI::App& app, CompareOptions& o) {
  addList(app, "--range", o.ranges, "Distances of the projected points [m], or inf")
      ->default_str(joined(o.ranges, ","));
  addWithDefault(app, "--grid", o.grid, "Grid of points over the image, COLUMNSxROWS");
  addWithDefault(
      app, "--focus-radius", o.request.maps.focus_radius_px,
      "Align over this radius around the image's centre with equal weights [px] (0: weighted by "
      "the projection uncertainty, or a sixth of the image if there is none)")
      ->check(numberFrom(0));
  // As mrcal 2 fits: for benchmarks against it alone, so that no help names it.
  app.add_option("--fit", o.fit, "Cost of the alignment: squares, or fourth-power")->group("");
  addWithDefault(app, "--uncertainty", o.uncertainty,
                 "How points are tied to the boards: cross-reprojection or mean-frames");
}

void declareCompare(CLI::App& app, CompareOptions& o) {
  app.add_option("calibrations", o.request.calibrations,
                 "Two or more calibrations of Plumbline, Kalibr, OpenVINS, yac or Basalt; "
                 "differences are relative to the first")
      ->required();
  addList(app, "--labels", o.request.labels, "Labels of the calibrations, e.g. ours,kalibr");
  o.session.declareOptional(app);
  app.get_option("--target-shape")
      ->description(
          "Shape of the board: flat, or a target_shape.yaml (default: the session's own, where its "
          "corners show one, else flat)");
  app.add_flag(
         "--no-session-estimate", o.no_session_estimate,
         "Do not calibrate the session itself for the comparison; scores then take its board as "
         "flat, unless --target-shape says otherwise")
      ->needs(app.get_option("--session"));
  declareMaps(app, o);
  o.measurements.declare(app);
  CLI::Option* runs =
      app.add_option("--runs", o.runs.runs,
                     "Trajectories estimated with these calibrations: a pattern with the fields "
                     "{calibration}, {sequence} and {run}");
  CLI::Option* truth =
      app.add_option("--truth", o.runs.truth,
                     "Ground truth of the trajectories: a pattern with {sequence}, or one file");
  runs->needs(truth);
  truth->needs(runs);
  const std::size_t before = app.get_options().size();
  declareCoverage(app, o.metrics);
  declareTrajectoryMetrics(app, o.metrics);
  // Without runs each would be without effect.
  std::vector<CLI::Option*> options = app.get_options({});
  for (std::size_t i = before; i < options.size(); ++i) {
    options[i]->needs(runs);
  }
  o.output.declareResult(app);
}

std::vector<double> rangesFrom(const std::vector<std::string>& words) {
  std::vector<double> ranges;
  for (const std::string& word : words) {
    const bool infinite = word == "inf" || word == "infinity";
    const auto range =
        infinite ? std::optional(std::numeric_limits<double>::infinity()) : finiteNumber(word);
    if (!range || *range <= 0) {
      throw InputError(fmt::format("--range {}: expected metres, or inf", word));
    }
    ranges.push_back(*range);
  }
  refuseRepeated("--range", ranges);
  return ranges;
}

CompareRequest compareRequest(const CompareOptions& o, const CLI::App& app) {
  CompareRequest request = o.request;
  request.session_estimate = !o.no_session_estimate;
  if (!o.session.session.empty()) {
    request.load = o.session.request();
    // Given calibrations are scored, whatever models sensor.yaml states.
    request.load->read.supported_models_only = false;
    // The session's own estimate takes the board as `calibrate` does, unless it is said to be flat.
    const bool said = app.get_option("--target-shape")->count() > 0;
    request.load->target = said ? TargetMode::kGiven : TargetMode::kAuto;
    request.score.camera.frames = o.measurements.frames;
    request.score.camera.frames.tolerance = request.load->read.sync_tolerance;
    request.score.camera.threads = threadCount(request.load->threads);
  }
  // Also without a recording: the record states what is assumed.
  request.score.camera.model() = o.measurements.chosen();
  request.score.camera_imu.model() = request.score.camera.model();
  request.score.camera_imu.frames = request.score.camera.frames;
  request.score.camera_imu.threads = request.score.camera.threads;
  request.alignment =
      wordFrom<FrameAlignment>("--uncertainty", o.uncertainty,
                               {{"cross-reprojection", FrameAlignment::kCrossReprojection},
                                {"mean-frames", FrameAlignment::kMeanFrames}});
  request.maps.fit = wordFrom<DifferenceFit>(
      "--fit", o.fit,
      {{"squares", DifferenceFit::kSquares}, {"fourth-power", DifferenceFit::kFourthPower}});
  request.maps.ranges_m = rangesFrom(o.ranges);
  // Of the form of an image's size, and of whole numbers from 1 like one.
  const Resolution grid = resolutionFrom(o.grid, "--grid");
  request.maps.grid = {grid.width, grid.height};
  request.provenance = makeProvenance("compare", givenOptions(app));
  return request;
}

std::optional<TrajectoryStudy> trajectoriesOf(const CompareOptions& o, const CLI::App& app) {
  if (app.get_option("--runs")->count() == 0) return {};
  // As by a variable of a shell that is not set.
  for (const auto& [option, pattern] :
       {std::pair("--runs", o.runs.runs), {"--truth", o.runs.truth}}) {
    if (pattern.empty()) throw InputError(fmt::format("{} is empty; expected a pattern", option));
  }
  RunsRequest request = o.runs;
  request.how = judgedAs(o.metrics);
  setLimits(o.metrics, request);
  // The field {calibration} of the pattern is a calibration's label; a run of none of them is
  // refused.
  request.calibrations = comparedLabels(o.request.calibrations, o.request.labels);
  return evaluateRuns(request);
}

std::vector<std::string> filesBesideSession(const CompareOptions& o) {
  std::vector<std::string> inputs = o.request.calibrations;
  for (const std::string& pattern : {o.runs.runs, o.runs.truth}) append(inputs, filesOf(pattern));
  return inputs;
}

/// What runs say counts like what the calibrations say: without it, failed ones pass.
void addRuns(TrajectoryStudy study, ComparisonRecord& record) {
  Verdict runs = trajectoryVerdict(study);
  const std::string headline = record.verdict.headline + " " + runs.headline;
  append(record.verdict.findings, std::move(runs.findings));
  record.verdict = makeVerdict(std::move(record.verdict.findings));
  record.verdict.headline = headline;
  record.trajectories = std::move(study);
}

int compare(const CompareOptions& o, const CLI::App& app) {
  ProgressBar bar;
  const CompareRequest request = compareRequest(o, app);
  ResultWriter out(o.output, o.output.request("comparison", o.session, filesBesideSession(o)));
  // Ahead of the scores, which take far longer: a pattern or a truth that is wrong is told at once.
  std::optional<TrajectoryStudy> trajectories = trajectoriesOf(o, app);
  ComparisonRecord record = compareCalibrations(request, bar.sink());
  nameOwners(record.scores, app);
  nameOwners(record.verdict, app);
  if (auto& own = record.session_estimate) own->problem = withOwners(own->problem, app);
  if (trajectories) addRuns(std::move(*trajectories), record);
  // The recording's hash, where there is one, with that of all the other files.
  record.provenance.input_hash =
      inputFilesHash(filesBesideSession(o), record.provenance.input_hash);
  bar.clear();
  const std::string runs =
      record.trajectories ? runsSummary(*record.trajectories) + "\n" : std::string();
  return out.finish(
      record,
      {{"comparison.json", documentOf(record)}, {"comparison.csv", comparisonTable(record)}},
      renderComparisonPage, runs + comparisonSummary(record));
}

}  // namespace

Command compareCommand() {
  return {"compare", "Compare calibrations: parameters, projections, scores",
          "plumbline compare ours/calibration.json kalibr/camchain-imucam.yaml --session recording "
          "--out comparison",
          withOptions(declareCompare, compare)};
}

}  // namespace plumbline
