// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/estimation_options.h"

#include <cmath>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrator/base/error.h"
#include "evaluate/cli/option_values.h"
#include "evaluate/results/parallel_for.h"

namespace plumbline {

void EstimationOptions::declare(CLI::App& app) {
  app.add_option(
      "--models", models,
      "pinhole-radtan or pinhole-equidistant, one for each camera (default: sensor.yaml)");
  app.add_option("--cameras", cameras,
                 "Calibration whose cameras are used as they are (Kalibr's camchain or ours)");
  app.add_flag("--no-imu", no_imu, "Calibrate the cameras only");
  app.add_option("--gravity", gravity, "Magnitude of gravity [m/s^2]")->capture_default_str();
  app.add_option("--loss", loss, "none, or cauchy:SCALE [px]")->capture_default_str();
  app.add_option("--pixel-sigma", pixel_sigma, "Standard deviation of a corner, per axis [px]")
      ->capture_default_str();
  app.add_option("--outliers", outliers, "none, sigma:K, or kalibr")->capture_default_str();
  app.add_option("--min-corners", min_corners, "Leave out views with fewer corners")
      ->capture_default_str();
}

CameraStageOptions EstimationOptions::cameraStage(const LoadRequest& load) const {
  requirePositive("--gravity", gravity);
  requirePositive("--pixel-sigma", pixel_sigma);
  requirePositive("--min-corners", min_corners);
  CameraStageOptions options;
  if (models) options.models = modelsFrom(*models);
  options.pixel_sigma = pixel_sigma;
  options.cauchy_px = lossFrom(loss);
  const auto [filter, sigmas] = outliersFrom(outliers);
  options.filter = filter;
  if (filter == CornerFilter::kSigma) options.filter_sigmas = sigmas;
  options.frames.tolerance = load.read.sync_tolerance;
  options.frames.min_corners = min_corners;
  options.threads = threadCount(load.threads);
  return options;
}

CameraImuOptions EstimationOptions::cameraImuStage(const CameraStageOptions& camera) const {
  CameraImuOptions options;
  options.pixel_sigma = camera.pixel_sigma;
  options.gravity_m_s2 = gravity;
  options.cauchy_px = camera.cauchy_px;
  options.filter = camera.filter;
  options.filter_sigmas = camera.filter_sigmas;
  options.frames = camera.frames;
  options.threads = camera.threads;
  return options;
}

std::vector<std::pair<std::string, std::string>> givenOptions(const CLI::App& app) {
  std::vector<std::pair<std::string, std::string>> given;
  for (const CLI::Option* option : app.get_options()) {
    const std::string name = option->get_name(false, false);
    if (option->count() == 0 || name == "--out" || name == "session") continue;
    given.emplace_back(name, option->get_expected_max() == 0
                                 ? "yes"
                                 : fmt::format("{}", fmt::join(option->results(), ",")));
  }
  return given;
}

void requirePositive(const char* option, double value) {
  if (value > 0 && std::isfinite(value)) return;
  throw InputError(fmt::format("{} {}: expected a positive number", option, value));
}

}  // namespace plumbline
