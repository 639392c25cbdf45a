// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/calibration/evaluate_calibration.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <utility>

#include <fmt/core.h>
#include <fmt/format.h>

#include "datasets/calibration/calibration_reader.h"
#include "datasets/session/session_reader.h"
#include "evaluate/calibration/calibrate_session.h"
#include "evaluate/lint/lint.h"
#include "evaluate/metrics/calibration/held_cameras.h"
#include "evaluate/metrics/calibration/held_imu.h"
#include "evaluate/metrics/calibration/parameters.h"
#include "evaluate/metrics/calibration/score.h"
#include "evaluate/metrics/sample_intervals.h"
#include "evaluate/results/provenance.h"
#include "evaluate/results/text.h"
#include "evaluate/session/load_session.h"

namespace plumbline {
namespace {

/// Another session, read as the first one is; segments of time belong to the first alone.
LoadRequest loadOf(const std::string& session, const LoadRequest& first) {
  LoadRequest load = first;
  load.session = session;
  load.read.from_s = 0;
  load.read.to_s = std::numeric_limits<double>::infinity();
  load.others.clear();
  return load;
}

/// All but what was computed.
CalibrationRecord recordOf(const LoadedSession& loaded, const EvaluateCalibrationRequest& asked) {
  CalibrationRecord record;
  attribute(record, asked.provenance, loaded);
  const ScoreOptions& score = asked.score;
  // The IMU's noise is assumed only where its part is scored.
  record.assumptions =
      assumptionsOf(score.camera, score.camera_imu, score.use_imu ? &loaded.session : nullptr);
  record.target = loaded.session.target;
  record.counts = loaded.counts;
  addSampleIntervals(loaded.session, record);
  return record;
}

/// Mistakes of convention and of units, in the file and against the recording. Densities are not
/// the file's here: those of the recording's imu.yaml are used.
std::vector<Finding> conventionFindings(const EvaluateCalibrationRequest& asked,
                                        const CalibrationFile& file, const Calibration& calibration,
                                        const Session& session) {
  LintedCalibration linted = lintedFrom(file, calibration);
  linted.noise_known = false;
  Session seen = session;
  if (!asked.score.use_imu) {
    linted.calibration.imu.reset();
    seen.imu.reset();
  }
  std::vector<Finding> found = lintCalibrations({&linted, 1});
  append(found, lintAgainstSession({&linted, 1}, seen));
  return found;
}

std::string rmse(const ErrorStatistics* e) {
  const bool known = e != nullptr && e->count > 0;
  return known ? fmt::format("{:>11.4f}", e->rmse_px) : fmt::format("{:>11}", "-");
}

std::string nameOf(const CalibrationScore& s) {
  if (s.part == "all") return s.session + (s.held_out ? ", held out" : "");
  return s.part + (s.held_out ? ", held out" : ", calibrated on");
}

std::string line(const CalibrationScore& s, const std::vector<std::string>& cameras,
                 std::size_t width) {
  if (s.reprojection.count == 0) return fmt::format("{:<{}}  {}\n", nameOf(s), width, s.problem);
  std::string text = fmt::format("{:<{}}", nameOf(s), width) + rmse(&s.reprojection);
  for (const std::string& camera : cameras) text += rmse(errorsOf(s, camera));
  text += rmse(s.camera_imu ? &*s.camera_imu : nullptr);
  text += fmt::format("{:>10}{:>8}\n", s.reprojection.count, s.views_used);
  // Corners were scored, and a part was not: the IMU, or a fold.
  if (!s.problem.empty()) text += "  " + s.problem + "\n";
  return text;
}

}  // namespace

void EvaluateCalibrationRequest::check() const {
  load.check();
  score.check();
}

Result<CalibrationRecord> evaluateCalibration(const EvaluateCalibrationRequest& asked,
                                              const ProgressSink& progress) {
  asked.check();
  const std::string label = std::filesystem::path(asked.calibration).filename().string();
  // First what explains files that are no calibrations.
  const CalibrationFile file(asked.calibration);
  Calibration read = file.calibration();
  const Calibration calibration = withDeviations(std::move(read), file.deviations());
  const CalibrationExtras from = file.extras();
  const auto scoredOn = [&](const Session& session) {
    return ScoredCalibration{label, matchCalibration(calibration, asked.calibration, session)};
  };
  const LoadedSession loaded = loadSession(asked.load, progress);
  const ScoredCalibration scored = scoredOn(loaded.session);
  checkTargetLayout(loaded, {});
  SessionScores on_session = scoreSession(scored, loaded.session, asked.score, progress);
  const CalibrationScore& whole = on_session.scores.front();
  const std::vector<Finding> mistakes =
      conventionFindings(asked, file, scored.calibration, loaded.session);
  // Without a single corner there is nothing to show: the reason is the result.
  if (whole.reprojection.count == 0) {
    std::string problem = whole.problem;
    for (const Finding& f : mistakes) problem += fmt::format("; {}: {}", f.evidence, f.advice);
    return Failure{FailureCode::kNoScore,
                   {{"calibration", label}, {"session", whole.session}, {"problem", problem}}};
  }
  const std::optional<bool> own = wasEstimatedFrom(from, loaded);
  on_session.scores.front().held_out = own == false;
  on_session.scores.front().in_sample = own == true;
  CalibrationRecord record = recordOf(loaded, asked);
  record.provenance.input_hash = inputFilesHash({asked.calibration}, loaded.input_hash);
  record.camera = std::move(on_session.camera);
  record.camera_imu = std::move(on_session.camera_imu);
  addViewImages(loaded, record);
  record.held = HeldCalibration{label, std::move(on_session.scores)};
  for (const std::string& folder : asked.held_out) {
    const LoadRequest load = loadOf(folder, asked.load);
    const LoadedSession other = loadSession(load, progress);
    const ScoredCalibration scored_on_other = scoredOn(other.session);
    checkTargetLayout(other, {});
    std::string& hash = record.provenance.input_hash;
    // One after the other: the order of the recordings counts, as they are listed in it.
    hash = inputFilesHash({}, hash + other.input_hash);
    progress("scoring " + other.session.name, -1);
    CalibrationScore score = scoreHeldOut(scored_on_other, other.session, asked.score);
    // The user says so; the files may say otherwise.
    const bool seen = haveOneInCommon(other.camera_hashes, loaded.camera_hashes) ||
                      wasEstimatedFrom(from, other) == true;
    if (seen) score.held_out = false;
    record.held->scores.push_back(std::move(score));
  }
  progress("testing the cameras", -1);
  std::vector<Finding> held = judgeHeldCameras(*record.camera, loaded.session, asked.score);
  if (record.camera_imu) progress("testing T_SC0 and the time offset", -1);
  const HeldOffset offset = file.statesTimeOffset() ? HeldOffset::kStated : HeldOffset::kAssumed;
  append(held, testHeldImu(scored.calibration, offset, loaded.session, asked.score),
         FindingSubject::kExtrinsics);
  record.verdict =
      scoreVerdict(record, unusedShapeOf(asked.calibration, from, asked.load), {mistakes, held});
  return record;
}

std::string evaluationSummary(const CalibrationRecord& record) {
  const HeldCalibration& evaluation = *record.held;
  const std::size_t width = nameWidth(evaluation.scores, 11, nameOf);
  std::string text = fmt::format("{}\n{:<{}}{:>11}", evaluation.file, "RMSE [px]", width, "all");
  const std::vector<std::string> cameras = cameraNames(evaluation.scores);
  for (const std::string& camera : cameras) text += fmt::format("{:>11}", camera);
  text += fmt::format("{:>11}{:>10}{:>8}\n", "with IMU", "corners", "views");
  for (const CalibrationScore& score : evaluation.scores) text += line(score, cameras, width);
  return text;
}

}  // namespace plumbline
