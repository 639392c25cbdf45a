// SPDX-License-Identifier: BSD-3-Clause
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "calibrator/base/error.h"
#include "evaluate/calibration/calibrate_session.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/options/option_lists.h"
#include "evaluate/cli/options/option_values.h"
#include "evaluate/cli/options/result_options.h"
#include "evaluate/cli/options/session_options.h"
#include "evaluate/cli/options/shared_options.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/results/provenance.h"
#include "evaluate/results/result_folder.h"
#include "report/html/pages.h"

namespace plumbline {
namespace {

struct CalibrateOptions {
  SessionOptions session;
  EstimationOptions estimation;
  ResultOptions output;
  std::optional<std::string> select_views;
  bool joint = false, residuals = false, no_halves = false;
  double imu_shift_ms = 0;
  std::vector<std::string> thresholds;
  CalibrateRequest request;  ///< what is no word
};

void declareEstimation(CLI::App& app, CalibrateOptions& o) {
  o.estimation.choose_models = true;
  o.estimation.declare(app);
  app.add_flag("--free-cameras", o.request.free_cameras,
               "Refine the cameras of --cameras: they are only start values")
      ->needs(app.get_option("--cameras"));
  // Of the camera-IMU stage both, which there is none of then.
  auto* no_imu = app.get_option("--no-imu");
  app.add_flag("--joint", o.joint, "Refine the cameras in the camera-IMU stage too")
      ->excludes(no_imu);
  app.add_option("--imu-shift-ms", o.imu_shift_ms,
                 "Add this to every IMU stamp before the calibration [ms]; the time offset that is "
                 "written is of the recording's own stamps")
      ->excludes(no_imu);
  app.add_option(
      "--select-views", o.select_views,
      "Select views: mi:0.2bits (by information gain, like Kalibr) or predicted-error:2% (as few "
      "as let the predicted error add at most 2 % to that of a corner); default: all views");
  app.add_option(
         "--resample", o.request.resamples,
         "Recalibrate on N bootstrap resamples of time segments and report the bootstrap std")
      // One draw has no scatter to take a deviation from.
      ->check(numberThat("0, or 2 or more", [](double n) { return n == 0 || n >= 2; }));
  app.add_flag("--no-halves", o.no_halves, "Do not compare the halves of the recording");
  addWithDefault(app, "--seed", o.request.seed, "Seed of resampling and view selection")
      ->check(seedFrom(0));
}

void declareOutput(CLI::App& app, CalibrateOptions& o) {
  o.output.declareResult(app);
  app.add_flag("--residuals", o.residuals, "Also write residuals.csv, one row per corner");
  app.add_option("--threshold", o.thresholds,
                 "Threshold of the verdict, NAME=CAUTION,BAD, e.g. rmse_px=1,2; repeatable")
      ->allow_extra_args(false);
}

CalibrateRequest calibrateRequest(const CalibrateOptions& o, const CLI::App& app) {
  CalibrateRequest request = o.request;
  o.estimation.estimate(o.session, request);
  if (o.select_views) {
    request.camera.select_views = viewSelectionFrom(*o.select_views);
    request.camera.select_views->seed = request.seed;
  }
  request.camera_imu.imu_shift_ns = nanosecondsFromMilliseconds("--imu-shift-ms", o.imu_shift_ms);
  request.camera_imu.free_cameras = o.joint;
  request.halves = !o.no_halves;
  request.use_imu = !o.estimation.no_imu;
  std::vector<std::string> names;
  for (const std::string& word : o.thresholds) {
    setThreshold(word, request.thresholds);
    names.push_back(word.substr(0, word.find('=')));
  }
  refuseRepeated("--threshold", std::move(names));
  request.provenance = makeProvenance("calibrate", givenOptions(app));
  return request;
}

int calibrate(const CalibrateOptions& o, const CLI::App& app) {
  ProgressBar bar;
  const CalibrateRequest request = calibrateRequest(o, app);
  ResultWriter out(o.output,
                   o.output.request("calibration", o.session, givenInputs({o.estimation.cameras})));
  const auto record = calibrateSession(request, bar.sink());
  bar.clear();
  if (!record) return tellFailure(record.failure(), app);
  bar.update("writing", -1);
  const std::vector<ResultFile> documents = calibrationFiles(*record, o.residuals);
  bar.clear();
  return out.finish(*record, documents, renderCalibrationPage, calibrationSummary(*record));
}

void declareCalibrate(CLI::App& app, CalibrateOptions& o) {
  o.session.declareEstimating(app);
  declareEstimation(app, o);
  declareOutput(app, o);
}

}  // namespace

void checkCalibrateLine(std::vector<std::string> reversed) {
  CLI::App app;
  CalibrateOptions options;
  declareCalibrate(app, options);
  parseReversed(app, "calibrate", std::move(reversed));
  calibrateRequest(options, app).check();
}

Command calibrateCommand() {
  return {"calibrate", "Calibrate cameras and IMU from a recording",
          "plumbline calibrate session --out result", withOptions(declareCalibrate, calibrate)};
}

}  // namespace plumbline
