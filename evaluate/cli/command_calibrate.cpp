// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <fmt/ranges.h>

#include "calibrator/base/error.h"
#include "evaluate/cli/calibration_summary.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/option_values.h"
#include "evaluate/cli/progress_bar.h"
#include "evaluate/cli/session_options.h"
#include "evaluate/workflow/calibrate_session.h"
#include "evaluate/workflow/parallel_for.h"
#include "evaluate/workflow/provenance.h"
#include "evaluate/workflow/result_folder.h"
#include "evaluate/workflow/write_results.h"

namespace plumbline {
namespace {

struct Options {
  SessionOptions session;
  std::string out;
  std::optional<std::string> models, cameras, select_views;
  bool free_cameras = false, joint = false, no_imu = false, no_report = false, residuals = false;
  double imu_shift_ms = 0;
  std::string loss = "cauchy:1.5";
  std::string outliers = "none";
  double gravity = 9.80655;
  double pixel_sigma = 1;
  int min_corners = 4;
  int resamples = 0;
  std::uint64_t seed = 1;
  std::vector<std::string> thresholds;
};

void declareModel(CLI::App& app, Options& o) {
  app.add_option(
      "--models", o.models,
      "pinhole-radtan or pinhole-equidistant, one for each camera (default: sensor.yaml)");
  app.add_option("--cameras", o.cameras,
                 "Calibration whose cameras are used as they are (Kalibr's camchain or ours)");
  app.add_flag("--free-cameras", o.free_cameras, "--cameras is only the start of the camera stage");
  app.add_flag("--joint", o.joint, "The camera-IMU stage refines the cameras too");
  app.add_flag("--no-imu", o.no_imu, "Calibrate the cameras only");
  app.add_option("--imu-shift-ms", o.imu_shift_ms, "Add this to every IMU stamp first [ms]");
  app.add_option("--gravity", o.gravity, "Magnitude of gravity [m/s^2]")->capture_default_str();
}

void declareEstimation(CLI::App& app, Options& o) {
  app.add_option("--loss", o.loss, "none, or cauchy:SCALE [px]")->capture_default_str();
  app.add_option("--pixel-sigma", o.pixel_sigma, "Standard deviation of a corner, per axis [px]")
      ->capture_default_str();
  app.add_option("--outliers", o.outliers, "none, sigma:K, or kalibr")->capture_default_str();
  app.add_option("--select-views", o.select_views,
                 "Keep only informative views, e.g. mi:0.2bits as Kalibr (default: all views)");
  app.add_option("--min-corners", o.min_corners, "Leave out views with fewer corners")
      ->capture_default_str();
  app.add_option("--resample", o.resamples,
                 "Solve again on N draws of time segments and report the spread");
  app.add_option("--seed", o.seed, "Seed of resampling and view selection")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
}

void declareOutput(CLI::App& app, Options& o) {
  app.add_option("--out", o.out, "Folder for the results")->required();
  app.add_flag("--residuals", o.residuals, "Also write residuals.csv, a row for each corner");
  app.add_flag("--no-report", o.no_report, "Write no report.html");
  app.add_option("--threshold", o.thresholds,
                 "Threshold of the verdict, NAME=DOUBTFUL,BAD, e.g. rmse_px=1,2; repeatable")
      ->allow_extra_args(false);
}

void checkNumbers(const Options& o) {
  const auto positive = [](const char* name, double value) {
    if (!(value > 0) || std::isinf(value))
      throw InputError(fmt::format("{} {}: expected a positive number", name, value));
  };
  positive("--gravity", o.gravity);
  positive("--pixel-sigma", o.pixel_sigma);
  positive("--min-corners", o.min_corners);
  if (o.resamples < 0 || o.resamples == 1) {
    throw InputError(fmt::format("--resample {}: expected 0 (none), or 2 and more", o.resamples));
  }
  if (o.free_cameras && !o.cameras) throw InputError("--free-cameras needs --cameras FILE");
}

CameraStageOptions cameraOptions(const Options& o, const LoadRequest& load) {
  CameraStageOptions options;
  if (o.models) options.models = modelsFrom(*o.models);
  options.pixel_sigma = o.pixel_sigma;
  options.cauchy_px = lossFrom(o.loss);
  const auto [filter, sigmas] = outliersFrom(o.outliers);
  options.filter = filter;
  if (filter == CornerFilter::kSigma) options.filter_sigmas = sigmas;
  if (o.select_views) {
    options.select_views = ViewSelectionOptions{selectionThresholdFrom(*o.select_views), o.seed};
  }
  options.frames.tolerance = load.read.sync_tolerance;
  options.frames.min_corners = o.min_corners;
  options.threads = threadCount(load.threads);
  return options;
}

CameraImuOptions cameraImuOptions(const Options& o, const CameraStageOptions& camera) {
  CameraImuOptions options;
  options.pixel_sigma = o.pixel_sigma;
  options.gravity_m_s2 = o.gravity;
  options.cauchy_px = camera.cauchy_px;
  options.imu_shift_ns = nanosecondsFromMilliseconds("--imu-shift-ms", o.imu_shift_ms);
  options.free_cameras = o.joint;
  options.filter = camera.filter;
  options.filter_sigmas = camera.filter_sigmas;
  options.frames = camera.frames;
  options.threads = camera.threads;
  return options;
}

CalibrateRequest requestOf(const Options& o, const CLI::App& app) {
  checkNumbers(o);
  CalibrateRequest request;
  request.load = o.session.request();
  request.load.read.read_imu = !o.no_imu;
  request.load.read.supported_models_only = !o.models && !o.cameras;
  request.camera = cameraOptions(o, request.load);
  request.camera_imu = cameraImuOptions(o, request.camera);
  request.cameras_file = o.cameras;
  request.free_cameras = o.free_cameras;
  request.use_imu = !o.no_imu;
  request.resamples = o.resamples;
  request.seed = o.seed;
  for (const std::string& word : o.thresholds) setThreshold(word, request.thresholds);
  std::vector<std::pair<std::string, std::string>> given;
  for (const CLI::Option* option : app.get_options()) {
    const std::string name = option->get_name(false, false);
    if (option->count() == 0 || name == "--out" || name == "session") continue;
    given.emplace_back(name, option->get_expected_max() == 0
                                 ? "yes"
                                 : fmt::format("{}", fmt::join(option->results(), ",")));
  }
  request.provenance = makeProvenance("calibrate", std::move(given));
  return request;
}

int calibrate(const Options& o, const CLI::App& app) {
  ProgressBar bar;
  refuseUnwritable(o.out);
  refuseInside(o.out, o.session.session, "--out");
  const auto record = calibrateSession(requestOf(o, app), bar.sink());
  bar.clear();
  if (!record) {
    const Failure& failure = record.failure();
    fmt::print(stderr, "plumbline: {}; {}\n", failure.message, failure.cure);
    // Data that contradict what a file states are bad input.
    return failure.reason == FailureReason::kImplausible ? kBadInput : kFailed;
  }
  bar.update("writing", -1);
  writeCalibrationResults(*record, o.out, {!o.no_report, o.residuals});
  bar.clear();
  fmt::print("{}", calibrationSummary(*record));
  const std::string page = o.out + (o.no_report ? "/calibration.json" : "/report.html");
  fmt::print("\n{}: {}\n", o.no_report ? "Result" : "Report", page);
  return kDone;
}

}  // namespace

Command calibrateCommand() {
  return {"calibrate", "Calibrate cameras and IMU from a recording",
          "plumbline calibrate session --out result", [](CLI::App& app) {
            auto options = std::make_shared<Options>();
            options->session.declare(app);
            declareModel(app, *options);
            declareEstimation(app, *options);
            declareOutput(app, *options);
            return std::function<int()>([options, &app] { return calibrate(*options, app); });
          }};
}

}  // namespace plumbline
