// SPDX-License-Identifier: BSD-3-Clause
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "calibrator/base/error.h"
#include "evaluate/calibration/calibrate_session.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/options/option_values.h"
#include "evaluate/cli/options/result_options.h"
#include "evaluate/cli/options/session_options.h"
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
  bool free_cameras = false, joint = false, residuals = false;
  bool no_halves = false;
  double imu_shift_ms = 0;
  int resamples = 0;
  std::uint64_t seed = 1;
  std::vector<std::string> thresholds;
};

void declareEstimation(CLI::App& app, CalibrateOptions& o) {
  o.estimation.choose_models = true;
  o.estimation.declare(app);
  app.add_flag("--free-cameras", o.free_cameras,
               "Refine the cameras of --cameras: they are only start values")
      ->needs(app.get_option("--cameras"));
  app.add_flag("--joint", o.joint, "Refine the cameras in the camera-IMU stage too");
  app.add_option("--imu-shift-ms", o.imu_shift_ms,
                 "Add this to every IMU stamp before the calibration [ms]");
  app.add_option(
      "--select-views", o.select_views,
      "Select views: mi:0.2bits (by information gain, like Kalibr) or predicted-error:2% (as few "
      "as keep the predicted error within 2 % of that of all views); default: all views");
  app.add_option(
         "--resample", o.resamples,
         "Recalibrate on N bootstrap resamples of time segments and report the bootstrap std")
      // One draw has no scatter to take a deviation from.
      ->check(CLI::IsMember({0}) | numberFrom(2));
  app.add_flag("--no-halves", o.no_halves, "Do not compare the halves of the recording");
  addWithDefault(app, "--seed", o.seed, "Seed of resampling and view selection")
      ->check(seedFrom(0));
}

void declareOutput(CLI::App& app, CalibrateOptions& o) {
  o.output.declareResult(app);
  app.add_flag("--residuals", o.residuals, "Also write residuals.csv, one row per corner");
  app.add_option("--threshold", o.thresholds,
                 "Threshold of the verdict, NAME=CAUTION,BAD, e.g. rmse_px=1,2; repeatable")
      ->allow_extra_args(false);
}

CameraStageOptions cameraOptions(const CalibrateOptions& o, const LoadRequest& load) {
  CameraStageOptions options = o.estimation.cameraStage(load);
  if (o.select_views) {
    options.select_views = viewSelectionFrom(*o.select_views);
    options.select_views->seed = o.seed;
  }
  return options;
}

CameraImuOptions cameraImuOptions(const CalibrateOptions& o, const CameraStageOptions& camera) {
  CameraImuOptions options = o.estimation.cameraImuStage(camera);
  options.imu_shift_ns = nanosecondsFromMilliseconds("--imu-shift-ms", o.imu_shift_ms);
  options.free_cameras = o.joint;
  return options;
}

CalibrateRequest calibrateRequest(const CalibrateOptions& o, const CLI::App& app) {
  CalibrateRequest request;
  request.load = o.session.request();
  request.load.read.read_imu = !o.estimation.no_imu;
  // What sensor.yaml states is of no matter where models come from an option or a file: without
  // either, one that cannot be calibrated is refused as it is read.
  request.load.read.supported_models_only = !o.estimation.models && !o.estimation.cameras;
  request.camera = cameraOptions(o, request.load);
  request.camera_imu = cameraImuOptions(o, request.camera);
  request.cameras_file = o.estimation.cameras;
  request.free_cameras = o.free_cameras;
  request.halves = !o.no_halves;
  request.use_imu = !o.estimation.no_imu;
  request.resamples = o.resamples;
  request.seed = o.seed;
  for (const std::string& word : o.thresholds) setThreshold(word, request.thresholds);
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
  if (!record) return tellFailure(record.failure());
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
  // Neither --help nor the work: the request alone.
  app.set_help_flag();
  app.parse(std::move(reversed));
  calibrateRequest(options, app).check();
}

Command calibrateCommand() {
  return {"calibrate", "Calibrate cameras and IMU from a recording",
          "plumbline calibrate session --out result", withOptions(declareCalibrate, calibrate)};
}

}  // namespace plumbline
