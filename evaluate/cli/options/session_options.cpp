// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/options/session_options.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "calibrator/base/enum_words.h"
#include "calibrator/base/error.h"
#include "evaluate/cli/options/option_lists.h"
#include "evaluate/cli/options/option_values.h"
#include "evaluate/cli/options/shared_options.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/results/progress.h"

namespace plumbline {
namespace {

constexpr int kMostThreads = 1024;
constexpr const char* kAuto = "auto";  // of --target-shape and --models
constexpr const char* kFlat = "flat";

/// Every other word is a path.
bool namesAFile(const std::string& target_shape) {
  return target_shape != kAuto && target_shape != kFlat;
}

}  // namespace

void SessionOptions::declare(CLI::App& app) {
  app.add_option("session", session, "Folder of the recording (EuRoC layout)")->required();
  declareDetails(app);
}

void SessionOptions::declareEstimating(CLI::App& app) {
  target_shape = kAuto;
  estimating_ = true;
  declare(app);
}

void SessionOptions::declareOptional(CLI::App& app) {
  auto* recording = app.add_option("--session", session, "Folder of a recording (EuRoC layout)");
  declareDetails(app);
  // Each would be without effect.
  for (const char* of_recording :
       {"--target", "--target-shape", "--imu", "--resolution", "--only", "--from", "--to",
        "--stride", "--sync-tolerance-ms", "--border-bits"}) {
    app.get_option(of_recording)->needs(recording);
  }
}

void SessionOptions::declareDetails(CLI::App& app) {
  app.add_option("--target", target, "Kalibr's target.yaml (default: in the session)");
  CLI::Option* const shape = app.add_option(
      "--target-shape", target_shape,
      target_shape == kAuto ? "Shape of the board: auto (estimated where the recording determines "
                              "it), flat, or the target_shape.yaml of another session"
                            : "Shape of the board: flat, or a target_shape.yaml (default: flat)");
  // Only there does stating the default change nothing.
  if (target_shape == kAuto) shape->capture_default_str();
  if (estimating_) {
    addWithDefault(app, "--target-degree", target_degree,
                   "Highest degree of an estimated shape: 4 where held-out frames ask for it, or 2")
        ->check(CLI::IsMember({2, 4}));
    app.add_flag("--no-target-corners", no_target_corners,
                 "No remainders of single corners beside degree 4, whatever held-out frames say");
  }
  app.add_option("--imu", imu, "Kalibr's imu.yaml (default: in the session)");
  app.add_option("--resolution", resolution, "WxH where sensor.yaml does not say");
  addList(app, "--only", only, "Use only these cameras, e.g. cam0,cam1");
  app.add_option("--from", from_s, "Ignore frames earlier than this [s after the first]")
      ->check(numberFrom(0));
  app.add_option("--to", to_s, "Ignore frames later than this [s after the first]")
      ->check(positiveNumber());
  addWithDefault(app, "--stride", stride, "Use every n-th frame")->check(numberFrom(1));
  addWithDefault(app, "--sync-tolerance-ms", sync_tolerance_ms,
                 "Largest time difference between the views of one frame [ms], beyond a constant "
                 "shift of a camera's stamps of up to a quarter of the frame interval")
      ->check(numberFrom(0));
  addWithDefault(app, "--threads", threads, "Threads (0: all cores); results do not depend on it")
      ->check(numberWithin(0, kMostThreads));
  auto* kept = app.add_option("--cache", cache, "Cache of detected corners (default: the user's)");
  app.add_flag("--no-cache", no_cache, "Do not cache corners")->excludes(kept);
  addWithDefault(app, "--border-bits", border_bits, "Black border of the tags: 2 (Kalibr) or 1")
      ->check(CLI::IsMember({1, 2}));
}

LoadRequest SessionOptions::request() const {
  LoadRequest request;
  request.session = session;
  request.read.target_path = target;
  request.read.imu_path = imu;
  if (estimating_) {
    request.target = target_shape == kAuto      ? TargetMode::kAuto
                     : namesAFile(target_shape) ? TargetMode::kKnown
                                                : TargetMode::kTested;
    request.target_degree = target_degree;
    request.target_corners = !no_target_corners;
  }
  // A command that does not calibrate takes the file's shape as it is.
  if (namesAFile(target_shape)) request.target_shape = target_shape;
  if (resolution) request.read.resolution = resolutionFrom(*resolution);
  request.read.from_s = from_s;
  if (to_s) request.read.to_s = *to_s;
  request.read.stride = stride;
  request.read.sync_tolerance =
      nanosecondsFromMilliseconds("--sync-tolerance-ms", sync_tolerance_ms);
  request.detector.border_bits = border_bits;
  request.cache = cacheFolder();
  if (!cache) {  // nobody asked for this one
    request.without_cache = [](const std::string& why) {
      complain(fmt::format("note: detected corners are not cached: {}", why));
    };
  }
  request.note = [](const std::string& what) { complain("note: " + what); };
  request.only = only;
  request.threads = threads;
  return request;
}

std::vector<std::string> SessionOptions::inputs() const {
  std::vector<std::string> given;
  if (!session.empty()) given.push_back(session);
  if (target) given.push_back(*target);
  if (imu) given.push_back(*imu);
  if (namesAFile(target_shape)) given.push_back(target_shape);
  return given;
}

std::optional<std::string> SessionOptions::cacheFolder() const {
  if (no_cache) return std::nullopt;
  return cache ? cache : defaultCacheFolder();
}

void MeasurementOptions::declare(CLI::App& app) {
  addWithDefault(app, "--gravity", model.gravity_m_s2, "Magnitude of gravity [m/s^2]")
      ->check(positiveNumber());
  addWithDefault(app, "--loss", loss, "Robust loss of the corners: none, or cauchy:SCALE [px]");
  addWithDefault(app, "--pixel-sigma", model.pixel_sigma,
                 "Standard deviation of a corner, per axis [px]")
      ->check(positiveNumber());
  addWithDefault(app, "--min-corners", frames.min_corners, "Ignore views with fewer corners")
      ->check(numberFrom(1));
}

MeasurementModel MeasurementOptions::chosen() const {
  MeasurementModel out = model;
  out.cauchy_px = lossFrom(loss);
  return out;
}

void EstimationOptions::declare(CLI::App& app) {
  app.add_option(
      "--models", models,
      choose_models
          ? "Lens models: auto (default; chosen per camera by the error on held-out frames), or " +
                calibratedModelWords() + ", one for each camera"
          : "Lens models: " + calibratedModelWords() +
                ", one for each camera (default: sensor.yaml)");
  app.add_option("--cameras", cameras,
                 "Calibration whose cameras are used and kept fixed: Plumbline's calibration.json, "
                 "Kalibr's or OpenVINS' camchain, yac's result, or Basalt's")
      ->excludes(app.get_option("--models"));  // the models are those of the file
  app.add_flag("--no-imu", no_imu, "Calibrate the cameras only");
  measurements.declare(app);
  addWithDefault(
      app, "--outliers", outliers,
      "Filter of the corners: none, sigma:K (K robust standard deviations), or kalibr (its "
      "rule: mean + 2 std of a view)");
}

CameraStageOptions EstimationOptions::cameraStage(const LoadRequest& load) const {
  CameraStageOptions options;
  if (choose_models && (!models || *models == kAuto)) {
    options.model_mode = ModelMode::kAuto;
  } else if (models) {
    options.models = modelsFrom(*models);
  }
  options.model() = measurements.chosen();
  const auto [filter, sigmas] = outliersFrom(outliers);
  options.filter = filter;
  // Of the other filters none has a K.
  if (filter == CornerFilter::kSigma) options.filter_sigmas = sigmas;
  options.target = load.target;
  options.target_degree = load.target_degree;
  options.target_corners = load.target_corners;
  options.frames = measurements.frames;
  options.frames.tolerance = load.read.sync_tolerance;
  options.threads = threadCount(load.threads);
  return options;
}

CameraImuOptions EstimationOptions::cameraImuStage(const CameraStageOptions& camera) const {
  CameraImuOptions options;
  options.model() = camera.model();
  options.filter = camera.filter;
  options.filter_sigmas = camera.filter_sigmas;
  options.frames = camera.frames;
  options.threads = camera.threads;
  return options;
}

}  // namespace plumbline
