// SPDX-License-Identifier: BSD-3-Clause
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "evaluate/calibration/evaluate_calibration.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/options/option_lists.h"
#include "evaluate/cli/options/result_options.h"
#include "evaluate/cli/options/session_options.h"
#include "evaluate/cli/options/shared_options.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/metrics/headline.h"
#include "evaluate/results/provenance.h"
#include "evaluate/results/result_folder.h"
#include "report/html/pages.h"
#include "report/records/documents.h"

namespace plumbline {
namespace {

constexpr int kMostFolds = 100;

struct EvaluateCalibrationOptions {
  EvaluateCalibrationRequest request;  ///< what is no word
  SessionOptions session;
  EstimationOptions estimation;
  ResultOptions output;
};

void declareEvaluateCalibration(CLI::App& app, EvaluateCalibrationOptions& o) {
  app.add_option("calibration", o.request.calibration,
                 "Calibration to score: Plumbline's calibration.json, Kalibr's or OpenVINS' "
                 "camchain*.yaml, yac's result, or Basalt's")
      ->required();
  o.session.declare(app);
  o.estimation.declare(app);
  // A calibration is given, and its own models are those to calibrate with.
  app.remove_option(app.get_option("--models"));
  app.remove_option(app.get_option("--cameras"));
  app.get_option("--no-imu")->description("Score the cameras only");
  addList(app, "--held-out", o.request.held_out,
          "Folders of further sessions, held out (not used for the calibration), with commas "
          "between them (a folder that exists under the whole word is one); repeatable",
          ListOf::kPaths);
  app.add_option("--folds", o.request.score.folds,
                 "K-fold cross-validation: recalibrate K times without one part of the session and "
                 "score that part")
      ->check(numberWithin(2, kMostFolds));
  o.output.declareResult(app);
}

EvaluateCalibrationRequest evaluateCalibrationRequest(const EvaluateCalibrationOptions& o,
                                                      const CLI::App& app) {
  EvaluateCalibrationRequest request = o.request;
  request.load = o.session.request();
  request.load.read.read_imu = !o.estimation.no_imu;
  // The calibration's models count, not those of sensor.yaml.
  request.load.read.supported_models_only = false;
  request.score.camera = o.estimation.cameraStage(request.load);
  request.score.camera_imu = o.estimation.cameraImuStage(request.score.camera);
  request.score.use_imu = !o.estimation.no_imu;
  auto given = givenOptions(app);
  // The record names the file itself, beside its scores.
  std::erase_if(given, [](const auto& option) { return option.first == "calibration"; });
  request.provenance = makeProvenance("evaluate calibration", std::move(given));
  return request;
}

int evaluateCalibrationFile(const EvaluateCalibrationOptions& o, const CLI::App& app) {
  ProgressBar bar;
  const EvaluateCalibrationRequest request = evaluateCalibrationRequest(o, app);
  std::vector<std::string> inputs = request.held_out;
  inputs.push_back(request.calibration);
  ResultWriter out(o.output,
                   o.output.request("scores of a calibration", o.session, std::move(inputs)));
  auto result = evaluateCalibration(request, bar.sink());
  bar.clear();
  if (!result) return tellFailure(result.failure(), app);
  nameOwners(result.value().held->scores, app);
  nameOwners(result.value().verdict, app);
  return out.finish(*result, {{"evaluation.json", documentOf(*result)}}, renderCalibrationPage,
                    evaluationSummary(*result) + "\n" + verdictText(result->verdict));
}

}  // namespace

Command evaluateCalibrationCommand() {
  return {"calibration", "Score a calibration on sessions: only poses are estimated",
          "plumbline evaluate calibration camchain-imucam.yaml session --folds 5 --out scores",
          withOptions(declareEvaluateCalibration, evaluateCalibrationFile)};
}

}  // namespace plumbline
