// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/calibration/calibrate_session.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include <fmt/core.h>

#include "calibrator/base/error.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/batch/halves.h"
#include "calibrator/batch/resample.h"
#include "calibrator/batch/two_stages.h"
#include "evaluate/metrics/calibration/both_stages.h"
#include "evaluate/metrics/calibration/uncertainty_maps.h"
#include "evaluate/metrics/coverage.h"
#include "evaluate/metrics/failure_text.h"
#include "evaluate/metrics/headline.h"
#include "evaluate/session/load_session.h"

namespace plumbline {
namespace {

ResampleSpread spreadOf(const ResampleSummary& summary, int draws) {
  return {draws, summary.failed, summary.names, summary.std};
}

// Reading and detection count in the total of both stages: each is then the time of a run that
// makes this stage alone.
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

// Marks the failure of a camera stage whose lens may be too wide for the model that was tried.
Failure withModelSuspect(Failure failure, const CalibrateRequest& request, const Session& session) {
  bool radtan = false;
  bool unstated = false;
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    const std::string& word = session.cameras[c].distortion_model;
    if (request.camera.model_mode == ModelMode::kAuto) break;  // all were tried
    const bool asked = c < request.camera.models.size();
    unstated = unstated || (!asked && word.empty());
    radtan = radtan || (asked ? request.camera.models[c].distortion == DistortionModel::kRadtan
                              : word.empty() || word == toString(DistortionModel::kRadtan));
  }
  // A lens too wide for radtan shows as views without a plausible pose, as a batch that does not
  // converge, or, where nobody vouches for the model, as parameters that nothing determines.
  const bool no_pose =
      failure.reason() == FailureReason::kTooFewViews && failure.input() == FaultyInput::kTarget;
  const bool suspect = no_pose || failure.reason() == FailureReason::kNotConverged ||
                       (failure.reason() == FailureReason::kNotObservable && unstated);
  // A start that was given comes with its models: none was tried.
  if (!radtan || !suspect || !request.camera.start.empty()) return failure;
  failure.values.emplace("radtan_suspect", unstated ? 2 : 1);
  return failure;
}

// Fills record.camera (and its bootstrap std); nothing where the cameras are given and fixed.
std::optional<Failure> cameraStage(const CalibrateRequest& request, const LoadedSession& loaded,
                                   const ProgressSink& progress, CalibrationRecord& record) {
  progress("calibrating the cameras", -1);
  auto stage = calibrateCameras(loaded.session, request.camera);
  if (!stage) return withModelSuspect(stage.failure(), request, loaded.session);
  record.camera = std::move(stage).value();
  // At infinity, where the map is one of directions: a range would be one that nobody asked for.
  record.projection_uncertainty = uncertaintyMaps(record.camera->cameras, loaded.session.name,
                                                  uncertaintyOfStage(*record.camera),
                                                  {std::numeric_limits<double>::infinity()});
  addLoading(loaded, record.camera->summary.seconds);
  if (request.halves) {
    progress("comparing the halves of the recording", -1);
    record.camera->summary.halves =
        checkCameraHalves(loaded.session, *record.camera, request.camera);
  }
  if (request.resamples > 0) {
    progress("resampling the cameras", -1);
    const auto spread =
        resampleCameras(loaded.session, *record.camera, resampleOptions(request), request.camera);
    if (!spread) return spread.failure();
    record.camera_resample = spreadOf(*spread, request.resamples);
  }
  return std::nullopt;
}

// Through both stages where both were solved; the camera batch starts from the board as stated.
Result<ResampleSummary> resampledCameraImu(const CalibrateRequest& request, const Session& session,
                                           const TargetShape& stated,
                                           const CalibrationRecord& record) {
  const ResampleOptions options = resampleOptions(request);
  if (!record.camera) {
    return resampleCameraImu(session, *record.camera_imu, options, request.camera_imu);
  }
  Session before = session;
  before.target.shape = stated;
  return resampleBothStages(before, *record.camera, *record.camera_imu, options, request.camera,
                            request.camera_imu);
}

// `stated`: the board before the camera stage.
std::optional<Failure> cameraImuStage(const CalibrateRequest& request, const LoadedSession& loaded,
                                      const std::vector<CameraCalibration>& cameras,
                                      const TargetShape& stated, const ProgressSink& progress,
                                      CalibrationRecord& record) {
  progress("calibrating camera and IMU", -1);
  auto stage = convergedCameraImu(loaded.session, cameras, request.camera_imu,
                                  record.camera ? &*record.camera : nullptr);
  if (!stage) return stage.failure();
  record.camera_imu = std::move(stage).value();
  if (request.halves) {
    record.camera_imu->summary.halves =
        checkCameraImuHalves(loaded.session, *record.camera_imu, request.camera_imu);
  }
  locateSamples(loaded, record.camera_imu->screening);
  addLoading(loaded, record.camera_imu->summary.seconds);
  if (request.resamples > 0) {
    progress("resampling camera and IMU", -1);
    const auto spread = resampledCameraImu(request, loaded.session, stated, record);
    if (!spread) return spread.failure();
    record.camera_imu_resample = spreadOf(*spread, request.resamples);
  }
  return std::nullopt;
}

/// Whether wrong cameras can be what failed: not of what was found in samples, stamps or coverage.
bool standsOnPoses(FailureCode code) {
  using Code = FailureCode;
  constexpr std::array kOnPoses = {
      Code::kRatesDoNotCorrelate,   Code::kStampsWander,      Code::kGyroscopeMirrored,
      Code::kGyroscopeInDegrees,    Code::kGyroscopeScale,    Code::kAccelerometerAxes,
      Code::kAccelerometerReversed, Code::kGravityDisagrees,  Code::kScaleDisagrees,
      Code::kTooFewPosedFrames,     Code::kOffsetLeftSamples, Code::kNoDescent,
      Code::kCameraImuNotConverged};
  return std::find(kOnPoses.begin(), kOnPoses.end(), code) != kOnPoses.end();
}

/// A failure of the camera-IMU stage, or, where poses of their own do not explain the corners
/// either, that of the cameras: then no cause in the IMU was tested.
Failure withCamerasSuspect(const Failure& failure, const CalibrateRequest& request,
                           const Session& session, const std::vector<CameraCalibration>& cameras,
                           const CalibrationRecord& record) {
  if (!standsOnPoses(failure.code)) return failure;
  StageSummary summary;
  if (record.camera) {
    summary = record.camera->summary;
  } else {
    const auto score = scoreCameras(session, cameras, request.camera);
    if (!score) return failure;
    summary = score->summary;
  }
  // The median, as false corners are no fault of the cameras.
  double worst = 0;
  std::vector<std::string> names;
  for (std::size_t c = 0; c < summary.per_camera.size(); ++c) {
    const double median = summary.per_camera[c].median_px;
    if (!(median > request.thresholds.rmse_px.caution)) continue;
    worst = std::max(worst, median);
    names.push_back(cameras[c].name);
  }
  if (names.empty()) return failure;
  return {FailureCode::kCamerasDoNotFit,
          {{"median_px", worst},
           {"cameras", names},
           {"given", record.camera ? 0 : 1},
           {"imu", textOf(failure).message}}};
}

/// Whether a camera's stamps alone contradict the gyroscope: it is refused for that, or a fault of
/// the stamps is the cause that its tests name.
bool contradictsGyroscope(const Result<CameraImuStageResult>& stage) {
  using Code = FailureCode;
  if (!stage) {
    const Code code = stage.failure().code;
    return code == Code::kRatesDoNotCorrelate || code == Code::kStampsWander;
  }
  if (!stage->faults || stage->faults->causes.empty()) return false;
  const UnmodelledFault cause = stage->faults->causes.front().fault;
  return cause == UnmodelledFault::kStampsWander || cause == UnmodelledFault::kClockStep ||
         cause == UnmodelledFault::kClockDrift;
}

/// Where some cameras alone contradict the gyroscope and others suit it, the failure that names the
/// former: then IMU and clock are not at fault.
std::optional<Failure> failureOfCameras(const Failure& failure, const CalibrateRequest& request,
                                        const Session& session,
                                        const std::vector<CameraCalibration>& cameras) {
  if (failure.code != FailureCode::kRatesDoNotCorrelate || cameras.size() < 2) return std::nullopt;
  CameraImuOptions options = request.camera_imu;
  options.noise_check = false;
  options.diagnose_faults = true;
  std::vector<std::string> odd;
  bool one_suits = false;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    Session alone = session;
    alone.cameras = {session.cameras[c]};
    std::vector<CameraCalibration> camera = {cameras[c]};
    camera.front().T_C0Ci = {};
    const auto stage = calibrateCameraImu(alone, camera, options);
    if (contradictsGyroscope(stage)) {
      odd.push_back(cameras[c].name);
    } else if (stage && stage->summary.converged) {
      one_suits = true;
    }
  }
  if (odd.empty() || !one_suits) return std::nullopt;
  Failure named = failure;
  named.values.emplace("cameras", odd);
  named.where = request.load.session;
  return named;
}

CalibrationRecord emptyRecord(const CalibrateRequest& request, const LoadedSession& loaded) {
  CalibrationRecord record;
  attribute(record, request.provenance, loaded);
  record.assumptions = assumptionsOf(request.camera, request.camera_imu);
  record.target = loaded.session.target;
  record.counts = loaded.counts;
  addSampleIntervals(loaded.session, record);
  return record;
}

InputError nothingToEstimate() {
  return InputError(
      "the cameras are given and fixed, and there is no IMU to calibrate: there is nothing to "
      "estimate; add imu0/data.csv and imu.yaml to the session, or refine the cameras");
}

}  // namespace

void CalibrateRequest::check() const {
  load.check();
  if (resamples < 0 || resamples == 1) {
    throw InputError(
        fmt::format("{} bootstrap solutions: expected 0 (none), or 2 and more", resamples));
  }
  if (free_cameras && !cameras_file) {
    throw InputError("cameras can be refined only if a file gives them");
  }
  if (cameras_file && !free_cameras && !use_imu) throw nothingToEstimate();
  camera.check();
  camera_imu.check();
}

Result<CalibrationRecord> calibrateSession(const CalibrateRequest& asked,
                                           const ProgressSink& progress) {
  asked.check();
  CalibrateRequest request = asked;
  // Estimates stand on this file as on the recording, so the input hash covers it.
  if (request.cameras_file) request.load.others.push_back(*request.cameras_file);
  LoadedSession loaded = loadSession(request.load, progress);
  // Before anything is estimated: under a wrong layout no tag may be found, the camera stage fails
  // for another reason, or does not fail at all.
  checkTargetLayout(loaded, {});
  if (const auto nothing = noTagSeen(loaded)) {
    return locate(*nothing, loaded, request.load.session);
  }
  auto& models = request.camera.models;
  // One model that is named is that of every camera.
  if (models.size() == 1) models.resize(loaded.session.cameras.size(), models.front());
  CalibrationRecord record = emptyRecord(request, loaded);
  std::vector<CameraCalibration> cameras;
  const TargetShape stated = loaded.session.target.shape;
  if (request.cameras_file) {
    cameras = readCameras(*request.cameras_file, loaded.session);
    if (request.free_cameras) request.camera.start = cameras;
    request.camera_imu.cameras_given = !request.free_cameras;
  }
  const bool with_imu = request.use_imu && loaded.session.imu.has_value();
  if (!with_imu && request.cameras_file && !request.free_cameras) {
    throw nothingToEstimate();
  }
  if (!request.cameras_file || request.free_cameras) {
    if (auto failure = cameraStage(request, loaded, progress, record)) {
      return locate(*failure, loaded, request.load.session);
    }
    cameras = record.camera->cameras;
    // From here on the estimated shape is the session's, for the camera-IMU stage and the record.
    loaded.session.target.shape = record.camera->target;
    record.target = loaded.session.target;
  }
  // Again with the distortion taken out, which allows a closer tolerance.
  checkTargetLayout(loaded, cameras);
  if (with_imu) {
    record.assumptions.imu_noise = loaded.session.imu->noise;
    if (auto failure = cameraImuStage(request, loaded, cameras, stated, progress, record)) {
      const Failure suspect =
          withCamerasSuspect(*failure, request, loaded.session, cameras, record);
      const auto of_cameras = failureOfCameras(suspect, request, loaded.session, cameras);
      return of_cameras ? *of_cameras : locate(suspect, loaded, request.load.session);
    }
  }
  addViewImages(loaded, record);
  record.verdict = judge(record, request.thresholds, &loaded.session, request.camera.frames);
  record.verdict.headline = calibrationHeadline(record);
  return record;
}

}  // namespace plumbline
