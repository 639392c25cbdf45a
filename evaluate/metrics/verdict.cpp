// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/verdict.h"

#include <utility>

#include "evaluate/metrics/rules/rules.h"

namespace plumbline {
namespace {

using Subject = FindingSubject;

Findings cameraFindings(const CalibrationRecord& record, const VerdictThresholds& t) {
  // The order counts: of all findings of the worst level the first is the headline (gravest()).
  const CameraStageResult& stage = *record.camera;
  Findings findings;
  append(findings, judgeConvergence(stage.summary, "cameras"), Subject::kCameras);
  append(findings, judgeResiduals({stage.residuals, stage.summary, stage.cameras}, "cameras", t),
         Subject::kCameras);
  append(findings, judgeBias(stage, t), Subject::kCameras);
  append(findings, judgeData(record, t), Subject::kRecording);
  append(findings, judgePrincipalPoints(stage, t), Subject::kCameras);
  append(findings, judgeResolutions(stage, t), Subject::kCameras);
  append(findings, judgeTarget(record, t), Subject::kRecording);
  append(findings, judgeTargetShape(stage, t), Subject::kRecording);
  append(findings, judgeRejected(stage.residuals, "cameras", t), Subject::kRecording);
  append(findings, judgeLeftOut(record, t), Subject::kRecording);
  append(findings, judgeCameraStd(record, t), Subject::kCameras);
  append(findings, judgeHalves(stage.summary, "cameras", t), Subject::kCameras);
  return findings;
}

Findings cameraImuFindings(const CalibrationRecord& record, const VerdictThresholds& t) {
  const CameraImuStageResult& stage = *record.camera_imu;
  Findings findings;
  append(findings, judgeConvergence(stage.summary, "camera-IMU"), Subject::kExtrinsics);
  append(findings, judgeResiduals({stage.residuals, stage.summary, stage.cameras}, "camera-IMU", t),
         Subject::kExtrinsics);
  append(findings, judgeRejected(stage.residuals, "camera-IMU", t), Subject::kRecording);
  append(findings, judgeFramesAndGaps(stage, t), Subject::kRecording);
  append(findings, judgeScreening(stage, t), Subject::kRecording);
  append(findings, judgeFaults(record, t), Subject::kExtrinsics);
  append(findings, judgeStampJitter(stage, t), Subject::kRecording);
  append(findings, judgeFramePoses(stage, t), Subject::kExtrinsics);
  append(findings, judgeIsolatedResiduals(stage, t), Subject::kExtrinsics);
  append(findings, judgeLongResiduals(stage, t), Subject::kExtrinsics);
  append(findings, judgeStatements(record, t), Subject::kExtrinsics);
  append(findings, judgeImuStd(record, t), Subject::kExtrinsics);
  append(findings, judgeHalves(stage.summary, "camera-IMU", t), Subject::kExtrinsics);
  append(findings, judgePlausibility(stage, t), Subject::kExtrinsics);
  append(findings, judgeDensity("gyroscope", stage.imu_summary.noise.gyro, record, t),
         Subject::kImuNoise);
  append(findings, judgeDensity("accelerometer", stage.imu_summary.noise.accel, record, t),
         Subject::kImuNoise);
  return findings;
}

}  // namespace

void append(std::vector<Finding>& to, std::vector<Finding> more,
            std::optional<FindingSubject> subject) {
  for (Finding& finding : more) {
    if (subject) finding.subject = *subject;
    to.push_back(std::move(finding));
  }
}

Verdict judge(const CalibrationRecord& record, const VerdictThresholds& t, const Session* session,
              const FrameOptions& pairing) {
  Findings findings;
  // Cameras first: what is wrong with them shows again in the camera-IMU stage, and of findings
  // equally bad the first one is told.
  if (record.camera) append(findings, cameraFindings(record, t));
  if (record.camera_imu) append(findings, cameraImuFindings(record, t));
  // A session is not stored with a record: a verdict made from a record alone is without its rules.
  if (session && (record.camera || record.camera_imu)) {
    append(findings, judgeFrameStamps(record, session->cameras, pairing, t), Subject::kRecording);
  }
  if (session && session->imu && record.camera_imu) {
    append(findings, judgeSamples(session->imu->samples, t), Subject::kRecording);
  }
  return makeVerdict(std::move(findings));
}

}  // namespace plumbline
