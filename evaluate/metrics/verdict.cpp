// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/verdict.h"

#include <utility>

#include "evaluate/metrics/rules/rules.h"

namespace plumbline {
namespace {

void append(Findings& findings, Findings more) {
  for (Finding& finding : more) findings.push_back(std::move(finding));
}

Findings cameraFindings(const CalibrationRecord& record, const VerdictThresholds& t) {
  const CameraStageResult& stage = *record.camera;
  Findings findings = judgeConvergence(stage.summary, "cameras");
  append(findings, judgeResiduals({stage.residuals, stage.summary, stage.cameras}, "cameras", t));
  append(findings, judgeData(record, t));
  append(findings, judgePrincipalPoints(stage, t));
  append(findings, judgeResolutions(stage, t));
  append(findings, judgeTarget(record, t));
  append(findings, judgeTargetShape(stage, t));
  append(findings, judgeRejected(stage.residuals, "cameras", t));
  append(findings, judgeLeftOut(record, t));
  append(findings, judgeCameraStd(record, t));
  return findings;
}

Findings cameraImuFindings(const CalibrationRecord& record, const VerdictThresholds& t) {
  const CameraImuStageResult& stage = *record.camera_imu;
  Findings findings = judgeConvergence(stage.summary, "camera-IMU");
  append(findings,
         judgeResiduals({stage.residuals, stage.summary, stage.cameras}, "camera-IMU", t));
  append(findings, judgeRejected(stage.residuals, "camera-IMU", t));
  append(findings, judgeFramesAndGaps(stage, t));
  append(findings, judgeScreening(stage, t));
  append(findings, judgeFaults(stage, t));
  append(findings, judgeStampJitter(stage, t));
  append(findings, judgeIsolatedResiduals(stage, t));
  append(findings, judgeLongResiduals(stage, t));
  append(findings, judgeStatements(record, t));
  append(findings, judgeImuStd(record, t));
  append(findings, judgePlausibility(stage, t));
  append(findings, judgeDensity("gyroscope", stage.imu_summary.noise.gyro, t));
  append(findings, judgeDensity("accelerometer", stage.imu_summary.noise.accel, t));
  return findings;
}

}  // namespace

Verdict judge(const CalibrationRecord& record, const VerdictThresholds& t,
              const std::vector<ImuSample>& samples) {
  Findings findings;
  if (record.camera) append(findings, cameraFindings(record, t));
  if (record.camera_imu) append(findings, cameraImuFindings(record, t));
  if (record.camera_imu && !samples.empty()) append(findings, judgeSamples(samples, t));
  return makeVerdict(std::move(findings));
}

}  // namespace plumbline
