// SPDX-License-Identifier: BSD-3-Clause
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "evaluate/metrics/calibration/score.h"
#include "evaluate/metrics/headline.h"
#include "evaluate/metrics/rules/rules.h"

namespace plumbline {
namespace {

void addUnscored(const std::vector<CalibrationScore>& scores, Findings& findings) {
  for (const CalibrationScore& s : scores) {
    if (s.problem.empty()) continue;
    Finding f;
    f.rule = fmt::format("Score on {}, {}", s.session, s.part);
    // With corners scored only a part is missing (the IMU's, a fold's); without there is no score.
    f.level = s.reprojection.count > 0 ? VerdictLevel::kCaution : VerdictLevel::kBad;
    f.evidence = s.problem;
    findings.push_back(std::move(f));
  }
}

/// A recording that was given as held out, and is not: its score is one in sample, maybe.
Finding notHeldOut(const CalibrationScore& s) {
  Finding f;
  f.rule = "Held-out recording " + s.session;
  f.level = VerdictLevel::kCaution;
  f.subject = FindingSubject::kRecording;
  f.evidence =
      "is not held out: it is the first recording, or has the name or the content of the one that "
      "the calibration's file says it was estimated from";
  f.advice = "give a recording that the calibration has not seen";
  return f;
}

/// RMSE of recordings and folds that the calibration has not seen; single folds are in their pool.
Findings judgeHeldOut(const std::vector<CalibrationScore>& scores, const VerdictThresholds& t) {
  Findings findings;
  for (const CalibrationScore& s : scores) {
    // "all" is a whole session, "all K folds" their pool; "fold k of K" are single ones.
    if (!s.part.starts_with("all") || s.reprojection.count == 0) continue;
    // Whole recordings behind the first were given as held out.
    const bool given = &s != &scores.front() && s.part == "all";
    if (given && !s.held_out) findings.push_back(notHeldOut(s));
    if (!given && !s.held_out) continue;
    const char* what = s.held_out ? "Held-out reprojection" : "Reprojection";
    findings.push_back(
        above({fmt::format("{} error on {}, {}", what, s.session, s.part), "px", t.rmse_px,
               "Compare with the error in sample: where that is small, the calibration does not "
               "hold for other views of the rig; record more of the image and calibrate again."},
              s.reprojection.rmse_px,
              fmt::format("RMSE {:.3f} px over {} corners", s.reprojection.rmse_px,
                          s.reprojection.count)));
  }
  return findings;
}

/// A board of another shape than the one assumed shows as errors of the calibration: it must be
/// said.
Finding unusedShape(const std::string& file) {
  Finding f;
  f.rule = "Shape of the target";
  f.level = VerdictLevel::kCaution;
  f.subject = FindingSubject::kRecording;
  f.evidence =
      "the board is assumed to be as target.yaml states; the calibration was estimated with the "
      "board shape of " +
      file;
  f.advice = "if this recording shows the same board, run again with --target-shape " + file;
  return f;
}

/// "0.36 px RMSE on euroc (0.40 px with the IMU), 0.37 px in all 5 folds (held out)".
std::string scoreWords(const std::vector<CalibrationScore>& scores) {
  std::string text;
  for (const CalibrationScore& s : scores) {
    const bool pooled = s.part.starts_with("all");
    if (!pooled || s.reprojection.count == 0) continue;
    // In-sample errors of the folds say nothing that the whole session's do not.
    if (s.part != "all" && !s.held_out) continue;
    text += fmt::format("{}{:.2f} px RMSE {} {}", text.empty() ? "" : ", ", s.reprojection.rmse_px,
                        s.part == "all" ? "on" : "in", s.part == "all" ? s.session : s.part);
    if (s.camera_imu) text += fmt::format(" ({:.2f} px with the IMU)", s.camera_imu->rmse_px);
    if (s.held_out) text += ", held out";
  }
  return text;
}

}  // namespace

std::vector<Finding> judgeScored(const std::optional<CameraStageResult>& camera,
                                 const std::optional<CameraImuStageResult>& camera_imu,
                                 const VerdictThresholds& thresholds) {
  Findings findings;
  if (camera) {
    append(findings,
           judgeResiduals({camera->residuals, camera->summary, camera->cameras}, "cameras",
                          thresholds),
           FindingSubject::kCameras);
  }
  if (camera_imu) {
    append(findings,
           judgeResiduals({camera_imu->residuals, camera_imu->summary, camera_imu->cameras},
                          "camera-IMU", thresholds),
           FindingSubject::kExtrinsics);
  }
  return findings;
}

Verdict scoreVerdict(const CalibrationRecord& record, const std::string& unused_shape,
                     const VerdictThresholds& thresholds) {
  Findings findings = judgeScored(record.camera, record.camera_imu, thresholds);
  append(findings, judgeHeldOut(record.held->scores, thresholds));
  addUnscored(record.held->scores, findings);
  if (!unused_shape.empty()) findings.push_back(unusedShape(unused_shape));
  Verdict verdict = makeVerdict(std::move(findings));
  verdict.headline = fmt::format("{}: {}; only poses are estimated.", record.held->file,
                                 scoreWords(record.held->scores));
  if (const std::string worst = worstFinding(verdict); !worst.empty()) {
    verdict.headline += " " + worst;
  }
  return verdict;
}

}  // namespace plumbline
