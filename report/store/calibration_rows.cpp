// SPDX-License-Identifier: BSD-3-Clause
#include "report/store/arrays.h"
#include "report/store/documents.h"
#include "report/store/metrics.h"
#include "report/store/record_rows.h"

namespace plumbline::store_internal {

void writeRecord(RunWriter& run, const CalibrationRecord& record) {
  run.metrics(metricsOf(record));
  run.parameters("camera", parameterEstimates(record, Stage::kCamera));
  run.parameters("camera_imu", parameterEstimates(record, Stage::kCameraImu));
  run.document("head", headDocument(record));
  if (const auto& stage = record.camera) {
    run.document("camera", cameraDocument(*stage));
    run.array("camera.frames", kFrameElement, packFrames(stage->frames));
    run.array("camera.T_FC0", kTransformElement, packTransforms(stage->T_FC0));
    run.array("camera.residuals", kResidualElement, packResiduals(stage->residuals));
  }
  if (const auto& stage = record.camera_imu) {
    run.document("camera_imu", cameraImuDocument(*stage));
    run.array("camera_imu.frames", kFrameElement, packFrames(stage->frames));
    run.array("camera_imu.states", kStateElement, packStates(stage->states));
    run.array("camera_imu.residuals", kResidualElement, packResiduals(stage->residuals));
    run.array("camera_imu.intervals", kIntervalElement, packIntervals(stage->imu_residuals));
  }
}

void readRecord(const RunReader& run, CalibrationRecord& record) {
  readHeadDocument(run.required("head"), record);
  if (const auto json = run.document("camera")) {
    CameraStageResult& stage = record.camera.emplace(readCameraDocument(*json));
    stage.frames = unpackFrames(run.array("camera.frames", kFrameElement));
    stage.T_FC0 = unpackTransforms(run.array("camera.T_FC0", kTransformElement));
    stage.residuals = unpackResiduals(run.array("camera.residuals", kResidualElement));
  }
  if (const auto json = run.document("camera_imu")) {
    CameraImuStageResult& stage = record.camera_imu.emplace(readCameraImuDocument(*json));
    stage.frames = unpackFrames(run.array("camera_imu.frames", kFrameElement));
    stage.states = unpackStates(run.array("camera_imu.states", kStateElement));
    stage.residuals = unpackResiduals(run.array("camera_imu.residuals", kResidualElement));
    stage.imu_residuals = unpackIntervals(run.array("camera_imu.intervals", kIntervalElement));
  }
}

}  // namespace plumbline::store_internal
