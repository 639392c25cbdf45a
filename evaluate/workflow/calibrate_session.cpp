// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/workflow/calibrate_session.h"

#include <utility>

#include <fmt/core.h>

#include "calibrator/batch/camera_imu_resample.h"
#include "calibrator/batch/resample.h"
#include "datasets/calibration_reader.h"
#include "datasets/supported_models.h"
#include "evaluate/workflow/locate_failure.h"

namespace plumbline {
namespace {

ResampleSpread spreadOf(const ResampleSummary& summary, int draws) {
  return {draws, summary.failed, summary.names, summary.std};
}

// A file keyed by position (Kalibr's) may hold another camera under this name: their topics tell.
void checkTopic(const CameraCalibration& given, const CameraStream& stream,
                const std::string& path) {
  const std::string& said = given.rostopic;
  const std::string expected =
      stream.rostopic.empty() ? "/" + stream.name + "/image_raw" : stream.rostopic;
  const bool generic = said.rfind("/cam", 0) == 0 && said.ends_with("/image_raw");
  if (said.empty() || said == expected || (stream.rostopic.empty() && !generic)) return;
  throw InputError(
      path, 0,
      fmt::format("{} is the calibration of topic {}, but the session's {} is {}; name "
                  "the cameras in the file as in the session",
                  stream.name, said, stream.name, expected));
}

// The calibration's cameras in the order of the session's, matched by name.
std::vector<CameraCalibration> matchCameras(const Calibration& given, const std::string& path,
                                            const Session& session) {
  std::vector<CameraCalibration> cameras;
  for (const CameraStream& stream : session.cameras) {
    const CameraCalibration* found = nullptr;
    for (const CameraCalibration& camera : given.cameras) {
      if (camera.name == stream.name) found = &camera;
    }
    if (found == nullptr) {
      throw InputError(path, 0, fmt::format("has no {}, which the session has", stream.name));
    }
    const Resolution& size = found->intrinsics.resolution;
    if (!(size == stream.resolution)) {
      throw InputError(
          path, 0,
          fmt::format("{} is for {}x{} pixels, the session's images have {}x{}", stream.name,
                      size.width, size.height, stream.resolution.width, stream.resolution.height));
    }
    checkTopic(*found, stream, path);
    const Intrinsics& k = found->intrinsics;
    if (!isSupportedModel(k.projection_model, k.distortion_model)) {
      throw InputError(path, 0,
                       fmt::format("{}: {}", stream.name,
                                   unsupportedModelText(toString(k.projection_model),
                                                        toString(k.distortion_model))));
    }
    cameras.push_back(*found);
  }
  // Camera 0 of the session is the reference, also where --only left the file's first camera out.
  const Transform T_0 = cameras.front().T_C0Ci.inverse();
  for (CameraCalibration& camera : cameras) camera.T_C0Ci = T_0 * camera.T_C0Ci;
  return cameras;
}

void addLoading(const LoadedSession& loaded, StageSeconds& seconds) {
  seconds.load = loaded.load_s;
  seconds.detect = loaded.detect_s;
  seconds.total += loaded.load_s + loaded.detect_s;
}

ResampleOptions resampleOptions(const CalibrateRequest& request) {
  ResampleOptions options;
  options.draws = request.resamples;
  options.seed = request.seed;
  options.threads = request.camera.threads;
  return options;
}

// Fills record.camera (and its resampled spread); nothing where the cameras are given and fixed.
std::optional<Failure> cameraStage(const CalibrateRequest& request, const LoadedSession& loaded,
                                   const ProgressSink& progress, CalibrationRecord& record) {
  progress("calibrating the cameras", -1);
  auto stage = calibrateCameras(loaded.session, request.camera);
  if (!stage) return stage.failure();
  record.camera = std::move(stage).value();
  addLoading(loaded, record.camera->summary.seconds);
  if (request.resamples > 0) {
    progress("resampling the cameras", -1);
    const auto spread =
        resampleCameras(loaded.session, *record.camera, resampleOptions(request), request.camera);
    if (!spread) return spread.failure();
    record.camera_resample = spreadOf(*spread, request.resamples);
  }
  return std::nullopt;
}

std::optional<Failure> cameraImuStage(const CalibrateRequest& request, const LoadedSession& loaded,
                                      const std::vector<CameraCalibration>& cameras,
                                      const ProgressSink& progress, CalibrationRecord& record) {
  progress("calibrating camera and IMU", -1);
  auto stage = calibrateCameraImu(loaded.session, cameras, request.camera_imu);
  if (!stage) return stage.failure();
  if (!stage->summary.converged) {
    return Failure{FailureReason::kNotConverged,
                   fmt::format("the camera-IMU calibration did not converge in {} iterations",
                               stage->summary.iterations),
                   "check imu.yaml's noise densities and the recording's motion, or calibrate the "
                   "cameras alone with --no-imu"};
  }
  record.camera_imu = std::move(stage).value();
  addLoading(loaded, record.camera_imu->summary.seconds);
  if (request.resamples > 0) {
    progress("resampling camera and IMU", -1);
    const auto spread = resampleCameraImu(loaded.session, *record.camera_imu,
                                          resampleOptions(request), request.camera_imu);
    if (!spread) return spread.failure();
    record.camera_imu_resample = spreadOf(*spread, request.resamples);
  }
  return std::nullopt;
}

CalibrationRecord emptyRecord(const CalibrateRequest& request, const LoadedSession& loaded) {
  CalibrationRecord record;
  record.name = loaded.session.name;
  record.provenance = request.provenance;
  record.provenance.input = loaded.session.name;
  record.provenance.input_hash = loaded.input_hash;
  record.assumptions.pixel_sigma_px = request.camera.pixel_sigma;
  record.assumptions.gravity_m_s2 = request.camera_imu.gravity_m_s2;
  record.assumptions.loss =
      request.camera.cauchy_px > 0 ? fmt::format("cauchy:{}", request.camera.cauchy_px) : "none";
  record.target = loaded.session.target;
  record.counts = loaded.counts;
  return record;
}

}  // namespace

Result<CalibrationRecord> calibrateSession(const CalibrateRequest& asked,
                                           const ProgressSink& progress) {
  CalibrateRequest request = asked;
  const LoadedSession loaded = loadSession(request.load, progress);
  auto& models = request.camera.models;
  if (models.size() == 1) models.resize(loaded.session.cameras.size(), models.front());
  CalibrationRecord record = emptyRecord(request, loaded);
  std::vector<CameraCalibration> cameras;
  if (request.cameras_file) {
    cameras =
        matchCameras(readCalibration(*request.cameras_file), *request.cameras_file, loaded.session);
    if (request.free_cameras) request.camera.start = cameras;
  }
  const bool with_imu = request.use_imu && loaded.session.imu.has_value();
  if (!with_imu && request.cameras_file && !request.free_cameras) {
    throw InputError(
        "--cameras fixes the cameras, and there is no IMU to calibrate: nothing is left to do; add "
        "imu0/data.csv and imu.yaml to the session, or --free-cameras");
  }
  if (!request.cameras_file || request.free_cameras) {
    if (auto failure = cameraStage(request, loaded, progress, record)) {
      return locate(*failure, request, loaded);
    }
    cameras = record.camera->cameras;
  }
  if (with_imu) {
    record.assumptions.imu_noise = loaded.session.imu->noise;
    if (auto failure = cameraImuStage(request, loaded, cameras, progress, record)) {
      return locate(*failure, request, loaded);
    }
  }
  record.verdict = judge(record, request.thresholds);
  return record;
}

}  // namespace plumbline
