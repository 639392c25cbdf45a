// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/verdict.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include <fmt/format.h>

#include "evaluate/metrics/headline.h"
#include "evaluate/metrics/lists.h"
#include "evaluate/metrics/rules/rules.h"
#include "report/records/shown_findings.h"

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
  append(findings, judgeDecentring(record, t));
  append(findings, judgeData(record, t), Subject::kRecording);
  append(findings, judgePrincipalPoints(stage, t), Subject::kCameras);
  append(findings, judgeResolutions(stage, t), Subject::kCameras);
  append(findings, judgeTarget(record, t), Subject::kRecording);
  append(findings, judgeTargetShape(stage, t), Subject::kRecording);
  append(findings, judgeRejected(stage.residuals, "cameras", t), Subject::kRecording);
  append(findings, judgeLeftOut(record, t), Subject::kRecording);
  append(findings, judgeCameraStd(record, t), Subject::kCameras);
  append(findings, judgeHalves(stage.summary, "cameras", t), Subject::kCameras);
  append(findings, judgeResample(record.camera_resample, "cameras"), Subject::kCameras);
  return findings;
}

Findings cameraImuFindings(const CalibrationRecord& record, const VerdictThresholds& t) {
  const CameraImuStageResult& stage = *record.camera_imu;
  Findings findings;
  append(findings, judgeConvergence(stage.summary, "camera-IMU"), Subject::kExtrinsics);
  append(findings, judgeSampling(stage), Subject::kRecording);
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
  append(findings, judgeResample(record.camera_imu_resample, "camera-IMU"), Subject::kExtrinsics);
  append(findings, judgePlausibility(stage, t), Subject::kExtrinsics);
  append(findings, judgeDensity("gyroscope", stage.imu_summary.noise.gyro, record, t),
         Subject::kImuNoise);
  append(findings, judgeDensity("accelerometer", stage.imu_summary.noise.accel, record, t),
         Subject::kImuNoise);
  return findings;
}

// A sentence of a text that is none yet: a capital first, a full stop last.
std::string sentence(std::string text) {
  if (text.empty()) return text;
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text + (text.ends_with('.') ? "" : ".");
}

/// What a good headline says of the camera-IMU stage; "" where there was none.
std::string imuWords(const CalibrationRecord& record) {
  const std::vector<ParameterEstimate> estimates = parameterEstimates(record, Stage::kCameraImu);
  if (estimates.empty()) return "";
  const auto largest = [&](const std::vector<std::string>& parts, const std::string& of) {
    // Of formal, cluster-robust and bootstrap deviations the largest that is known.
    return largestStd(estimates, parts, of, false).value;
  };
  return fmt::format(
      "; T_SC0 to {:.2g} mm and {:.2g} deg (1 sigma, worst axis, the largest of formal, robust and "
      "bootstrap), time offset to {:.2g} ms",
      1e3 * largest({"tx", "ty", "tz"}, "T_SC0"), kDegrees * largest({"rx", "ry", "rz"}, "T_SC0"),
      1e3 * largestOffsetStd(estimates, record.camera_imu->cameras).value);
}

/// "; all 60 rules are met"; those that could not be judged are named.
std::string rulesMet(const Findings& findings) {
  std::vector<std::string> open;
  for (const Finding& f : findings) {
    if (isNotJudged(f)) open.push_back(f.rule);
  }
  if (open.empty()) return fmt::format("; all {} rules are met", findings.size());
  return fmt::format("; {} of {} rules are met, not judged: {}", findings.size() - open.size(),
                     findings.size(), joined(open));
}

/// "  not judged - Bootstrap (cameras), Bootstrap (camera-IMU): why": the reason is the same of
/// all.
std::string openText(const Findings& same) {
  std::vector<std::string> rules;
  for (const Finding& f : same) rules.push_back(f.rule);
  return fmt::format("  not judged - {}: {}\n", joined(rules), shownEvidence(same.front()));
}

/// Of a mono camera alone nothing that is calibrated has a length.
bool hasLengths(const CalibrationRecord& record) {
  return record.camera_imu || (record.camera && record.camera->cameras.size() > 1);
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

std::string worstFinding(const Verdict& verdict) {
  const Finding* worst = gravest(verdict);
  if (worst == nullptr) return "";
  const std::string text = sentence(worst->rule + ": " + worst->evidence);
  return worst->advice.empty() ? text : text + " " + sentence(worst->advice);
}

std::string headlineOf(const Verdict& verdict, const std::string& good) {
  const auto& findings = verdict.findings;
  if (verdict.level == VerdictLevel::kGood) return sentence(good);
  // Besides the one that is told.
  const auto others =
      std::count_if(findings.begin(), findings.end(),
                    [](const Finding& f) { return f.level != VerdictLevel::kGood; }) -
      1;
  std::string text = worstFinding(verdict);
  if (others > 0) text += fmt::format(" {} more finding{} below.", others, others == 1 ? "" : "s");
  return text;
}

std::string calibrationHeadline(const CalibrationRecord& record, const VerdictThresholds& t) {
  // Cameras that were given are those that the camera-IMU stage held.
  const StageSummary* cameras = record.camera       ? &record.camera->summary
                                : record.camera_imu ? &record.camera_imu->summary
                                                    : nullptr;
  std::string good = cameras == nullptr
                         ? "nothing was calibrated"
                         : fmt::format("cameras to {:.2f} px RMSE", cameras->reprojection.rmse_px);
  good += imuWords(record);
  good += rulesMet(record.verdict.findings);
  if (hasLengths(record) && !testsTargetSize(record, t)) {
    good += "; scale rests on the stated size of the target, which this recording does not test";
  }
  return headlineOf(record.verdict, good);
}

std::string verdictText(const Verdict& verdict, const std::string& good_word) {
  std::string word = verdict.level == VerdictLevel::kGood ? good_word : toString(verdict.level);
  for (char& c : word) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::string text = fmt::format("Verdict: {}\n{}", word, verdict.headline);
  if (!verdict.headline.empty()) text += "\n";
  // Findings that one advice mends stand together, with the advice once.
  for (const std::vector<Finding>& same : shownFindings(verdict.findings)) {
    const Finding& first = same.front();
    if (isNotJudged(first)) text += openText(same);
    if (first.level == VerdictLevel::kGood) continue;
    for (const Finding& f : same) {
      text += fmt::format("  {} - {}: {}\n", toString(f.level), f.rule, f.evidence);
    }
    if (!first.advice.empty()) text += fmt::format("      {}\n", sentence(first.advice));
  }
  return text;
}

}  // namespace plumbline
