// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/calibration/failure_causes.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "evaluate/calibration/cameras_apart.h"
#include "evaluate/metrics/failure_text.h"

namespace plumbline {
namespace {

/// A failure of cameras together that each of them alone may explain otherwise.
bool isOfAllCameras(FailureCode code) {
  using Code = FailureCode;
  constexpr std::array kTogether = {Code::kNoFramePose,         Code::kFocalLengthFree,
                                    Code::kPrincipalPointFree,  Code::kExtrinsicsFree,
                                    Code::kDistortionFree,      Code::kInformationSingular,
                                    Code::kCamerasNotConverged, Code::kCamerasDoNotFit};
  return std::find(kTogether.begin(), kTogether.end(), code) != kTogether.end();
}

/// `first`, and behind it what else was found: "also cam2 alone: ...", with what mends it where
/// that is something else.
Failure withFurther(Failure first, const std::vector<Failure>& further) {
  if (further.empty()) return first;
  std::vector<std::string> also, cures, said{textOf(first).cure};
  for (const Failure& failure : further) {
    const FailureText text = textOf(failure);
    also.push_back(text.message);
    if (std::find(said.begin(), said.end(), text.cure) != said.end()) continue;
    said.push_back(text.cure);
    cures.push_back("of " + std::get<std::string>(failure.values.at("alone").content()) + ": " +
                    text.cure);
  }
  first.values.insert({{"also", also}, {"also_cures", cures}});
  return first;
}

/// With what single cameras tell: where each explains its corners alone, but no transform joins two
/// of them, that is what failed; where the camera that the failure names does, and others do not,
/// the failure is theirs, by their names; else the others' follow the failure.
Failure withCamerasAlone(Failure failure, const CalibrateRequest& request, const Session& session) {
  if (session.cameras.size() < 2 || !isOfAllCameras(failure.code)) return failure;
  const auto alone = calibratedAlone(session, request.camera);
  const auto named = failure.values.find("camera");
  bool named_fits = false;
  double worst_px = 0;
  std::vector<Failure> others;
  for (std::size_t c = 0; c < alone.size(); ++c) {
    const bool is_named = named != failure.values.end() &&
                          std::get<std::string>(named->second.content()) == session.cameras[c].name;
    if (!alone[c]) {
      if (is_named) continue;
      others.push_back(alone[c].failure());
      others.back().values.emplace("alone", session.cameras[c].name);
      continue;
    }
    const double rmse_px = alone[c]->summary.reprojection.rmse_px;
    if (isLarger(rmse_px, worst_px)) worst_px = rmse_px;
    if (is_named) named_fits = true;
  }
  if (!others.empty() && !named_fits) return withFurther(failure, others);
  if (!others.empty()) return withFurther(others.front(), {others.begin() + 1, others.end()});
  if (!(worst_px <= request.thresholds.rmse_px.caution)) return failure;
  const auto apart = camerasApart(session, alone, request.camera.frames);
  if (!apart) return failure;
  failure.values.insert({{"alone_px", worst_px},
                         {"apart", std::vector<std::string>{apart->first, apart->second}},
                         {"turn_deg", apart->turn_deg},
                         {"turn_frames", apart->frames}});
  return failure;
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
  const Failure unfit{FailureCode::kCamerasDoNotFit,
                      {{"median_px", worst},
                       {"cameras", names},
                       {"given", record.camera ? 0 : 1},
                       {"imu", textOf(failure).message}}};
  return record.camera ? withCamerasAlone(unfit, request, session) : unfit;
}

/// Whether a camera's stamps alone contradict the gyroscope: it is refused for that, or a fault of
/// the stamps is among the causes that its tests name.
bool contradictsGyroscope(const Result<CameraImuStageResult>& stage) {
  using Code = FailureCode;
  if (!stage) {
    const Code code = stage.failure().code;
    return code == Code::kRatesDoNotCorrelate || code == Code::kStampsWander;
  }
  if (!stage->faults) return false;
  const auto isOfStamps = [](const FaultTest& cause) {
    return cause.fault == UnmodelledFault::kStampsWander ||
           cause.fault == UnmodelledFault::kClockStep ||
           cause.fault == UnmodelledFault::kClockDrift;
  };
  return std::any_of(stage->faults->causes.begin(), stage->faults->causes.end(), isOfStamps);
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

}  // namespace

Failure causeOfCameraFailure(const Failure& failure, const CalibrateRequest& request,
                             const Session& session) {
  // Frames that a selection left may be what is missing.
  const bool chosen = failure.values.count("selected_frames") > 0;
  return withModelSuspect(chosen ? failure : withCamerasAlone(failure, request, session), request,
                          session);
}

Failure causeOfImuFailure(const Failure& failure, const CalibrateRequest& request,
                          const LoadedSession& loaded,
                          const std::vector<CameraCalibration>& cameras,
                          const CalibrationRecord& record) {
  const Failure suspect = withCamerasSuspect(failure, request, loaded.session, cameras, record);
  const auto of_cameras = failureOfCameras(suspect, request, loaded.session, cameras);
  return of_cameras ? *of_cameras : locate(suspect, loaded, request.load.session);
}

}  // namespace plumbline
