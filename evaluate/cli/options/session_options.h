// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "evaluate/session/load_session.h"

namespace plumbline {

/// The options of every command that reads a recording.
struct SessionOptions {
  std::string session;
  std::optional<std::string> target, imu, resolution, cache;
  bool no_cache = false;
  std::vector<std::string> only;
  /// "flat", a file, or in commands that calibrate, "auto".
  std::string target_shape = "flat";
  int target_degree = 4;
  bool no_target_corners = false;
  double from_s = 0;
  std::optional<double> to_s;
  int stride = 1;
  double sync_tolerance_ms = 2;
  int threads = 0;
  int border_bits = 2;

  void declare(CLI::App& app);
  /// The same for a command that calibrates, whose board may be estimated: --target-shape auto.
  void declareEstimating(CLI::App& app);
  /// The same where a recording is optional: --session; `session` stays empty without it.
  void declareOptional(CLI::App& app);
  /// Checks the values and turns them into what the workflow asks for.
  LoadRequest request() const;
  /// Files and folders that were given to be read.
  std::vector<std::string> inputs() const;
  /// Where found corners are kept; empty: nowhere.
  std::optional<std::string> cacheFolder() const;

 private:
  void declareDetails(CLI::App& app);

  bool estimating_ = false;  // whether the board's shape is a question of the command
};

/// What is assumed of the measurements, and which views count; defaults are the library's.
struct MeasurementOptions {
  MeasurementModel model;
  FrameOptions frames;
  std::string loss = lossText(model.cauchy_px);

  void declare(CLI::App& app);
  /// With the loss; InputError where that is none.
  MeasurementModel chosen() const;
};

/// The options of every command that calibrates a recording, as `plumbline calibrate` declares
/// them.
struct EstimationOptions {
  std::optional<std::string> models, cameras;
  bool choose_models = false;  ///< --models auto is known, and the default
  bool no_imu = false;
  MeasurementOptions measurements;
  std::string outliers = "none";

  void declare(CLI::App& app);
  /// Both stages' options; InputError for values out of range.
  CameraStageOptions cameraStage(const LoadRequest& load) const;
  CameraImuOptions cameraImuStage(const CameraStageOptions& camera) const;
  /// What a request to calibrate `session` has of them.
  template <class Request>
  void estimate(const SessionOptions& session, Request& request) const {
    request.load = session.request();
    request.load.read.read_imu = !no_imu;
    // What sensor.yaml states is of no matter where models come from an option or a file: without
    // either, one that cannot be calibrated is refused as it is read.
    request.load.read.supported_models_only = !models && !cameras;
    request.camera = cameraStage(request.load);
    request.camera_imu = cameraImuStage(request.camera);
    request.cameras_file = cameras;
  }
};

}  // namespace plumbline
