// SPDX-License-Identifier: BSD-3-Clause
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "evaluate/metrics/calibration/score.h"
#include "evaluate/metrics/headline.h"
#include "evaluate/metrics/lists.h"
#include "evaluate/metrics/rules/rules.h"

namespace plumbline {
namespace {

constexpr VerdictThresholds kUsual;  // those of a calibration's own verdict

void addUnscored(const std::vector<CalibrationScore>& scores, Findings& findings) {
  for (const CalibrationScore& s : scores) {
    if (s.problem.empty()) continue;
    // With corners scored only a part is missing (the IMU's, a fold's); without there is no score.
    Finding f{fmt::format("Score on {}, {}", s.session, s.part),
              s.reprojection.count > 0 ? VerdictLevel::kCaution : VerdictLevel::kBad, s.problem};
    if (s.part == "all" && s.problem.starts_with("camera-IMU")) {
      f.subject = FindingSubject::kExtrinsics;
    }
    findings.push_back(std::move(f));
  }
}

/// A recording that was given as held out, and is not: its score is one in sample, maybe.
Finding notHeldOut(const CalibrationScore& s) {
  Finding f{"Held-out recording " + s.session, VerdictLevel::kCaution,
            "is not held out: it is the first recording, or has the name or the content of the one "
            "that the calibration's file says it was estimated from",
            "give a recording that the calibration has not seen"};
  f.subject = FindingSubject::kRecording;
  return f;
}

/// RMSE of recordings and folds that the calibration has not seen; single folds are in their pool.
Findings judgeHeldOut(const std::vector<CalibrationScore>& scores) {
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
        above({fmt::format("{} error on {}, {}", what, s.session, s.part), "px", kUsual.rmse_px,
               "Compare with the error in sample: where that is small, the calibration does not "
               "hold for other views of the rig; record more of the image and calibrate again."},
              s.reprojection.rmse_px,
              fmt::format("RMSE {:.3f} px over {} corners", s.reprojection.rmse_px,
                          s.reprojection.count)));
  }
  return findings;
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

Finding unusedShape(const std::string& file) {
  Finding f{"Shape of the target", VerdictLevel::kCaution,
            "the board is assumed to be as target.yaml states, but " + file +
                " lies beside the calibration",
            "if the calibration was estimated with that shape, and this recording shows the same "
            "board, run again with --target-shape " +
                file};
  f.subject = FindingSubject::kRecording;
  return f;
}

std::vector<Finding> judgeScored(const std::optional<CameraStageResult>& camera,
                                 const std::optional<CameraImuStageResult>& camera_imu) {
  Findings findings;
  const auto add = [&](const auto& stage, const char* name, FindingSubject subject,
                       const char* advice) {
    if (!stage) return;
    Findings errors =
        judgeResiduals({stage->residuals, stage->summary, stage->cameras}, name, kUsual);
    // The rules' own advice is to who calibrates.
    for (Finding& f : errors) f.advice = f.advice.empty() ? "" : advice;
    append(findings, std::move(errors), subject);
  };
  add(camera, "cameras", FindingSubject::kCameras,
      "Poses of their own do not explain the corners: the cameras are not those of this recording, "
      "their lens model does not fit, or corners and board are at fault (blur, a bent target). "
      "Calibrate a recording of this rig and see its verdict.");
  add(camera_imu, "camera-IMU", FindingSubject::kExtrinsics,
      "Compare with the error of the cameras alone: where that is small, T_SC0, the time offset or "
      "the IMU contradict the cameras.");
  return findings;
}

Verdict scoreVerdict(const CalibrationRecord& record, const std::string& unused_shape,
                     const HeldFindings& held) {
  Findings findings = held.mistakes;
  append(findings, judgeScored(record.camera, record.camera_imu));
  append(findings, held.tests);
  append(findings, judgeHeldOut(record.held->scores));
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
