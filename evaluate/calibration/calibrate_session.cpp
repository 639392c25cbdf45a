// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/calibration/calibrate_session.h"

#include <limits>
#include <utility>

#include <fmt/core.h>

#include "calibrator/base/error.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/batch/halves.h"
#include "calibrator/batch/resample.h"
#include "calibrator/batch/two_stages.h"
#include "evaluate/calibration/failure_causes.h"
#include "evaluate/metrics/calibration/both_stages.h"
#include "evaluate/metrics/calibration/uncertainty_maps.h"
#include "evaluate/metrics/headline.h"
#include "evaluate/metrics/rules/rules.h"
#include "evaluate/metrics/sample_intervals.h"
#include "evaluate/session/load_session.h"

namespace plumbline {
namespace {

/// A calibration stands without its bootstrap: where too few draws have a solution there is no
/// spread, and the verdict says so.
ResampleSpread spreadOf(const Result<ResampleSummary>& summary, int draws) {
  if (summary) return {draws, summary->failed, summary->names, summary->std};
  return {draws, static_cast<int>(summary.failure().number("failed")), {}, {}};
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

// Fills record.camera (and its bootstrap std); nothing where the cameras are given and fixed.
std::optional<Failure> cameraStage(const CalibrateRequest& request, const LoadedSession& loaded,
                                   const ProgressSink& progress, CalibrationRecord& record) {
  progress("calibrating the cameras", -1);
  auto stage = calibrateCameras(loaded.session, request.camera);
  if (!stage) return causeOfCameraFailure(stage.failure(), request, loaded.session);
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
    record.camera_resample = spreadOf(
        resampleCameras(loaded.session, *record.camera, resampleOptions(request), request.camera),
        request.resamples);
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
    record.camera_imu_resample =
        spreadOf(resampledCameraImu(request, loaded.session, stated, record), request.resamples);
  }
  return std::nullopt;
}

/// Offsets were estimated against stamps moved by --imu-shift-ms, and judged so: whoever gives a
/// shift knows that the clocks are apart. The result is of the recording's own: t_imu = t_cam +
/// t_d.
void undoShift(TimeNs imu_shift, CalibrationRecord& record) {
  if (imu_shift == 0 || !record.camera_imu) return;
  for (TimeOffset& offset : record.camera_imu->imu.time_offsets) {
    offset.s -= 1e-9 * static_cast<double>(imu_shift);
  }
  for (Finding& f : record.verdict.findings) {
    if (f.rule != kOffsetSizeRule) continue;
    f.evidence +=
        fmt::format(", of stamps shifted by {:g} ms", 1e-6 * static_cast<double>(imu_shift));
  }
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
  request.camera.common_error_share = loaded.common_error_share;
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
      return causeOfImuFailure(*failure, request, loaded, cameras, record);
    }
  }
  addViewImages(loaded, record);
  record.verdict = judge(record, request.thresholds, &loaded.session, request.camera.frames);
  undoShift(request.camera_imu.imu_shift_ns, record);
  record.verdict.headline = calibrationHeadline(record, request.thresholds);
  return record;
}

}  // namespace plumbline
