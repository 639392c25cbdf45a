// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <string>

#include <nlohmann/json.hpp>

#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"
#include "datasets/session/session_reader.h"
#include "datasets/session/suggestions_reader.h"
#include "evaluate/metrics/half_width.h"
#include "evaluate/metrics/headline.h"
#include "evaluate/replay/suggestion_outcomes.h"
#include "evaluate/results/result_folder.h"
#include "evaluate/study/run_step.h"
#include "report/store/store.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

/// None without suggestions that ended: nothing to follow is no compliance of 0.
std::optional<double> shareReached(const OperatorCompliance& compliance) {
  const int ended = endedSuggestions(compliance);
  if (ended == 0) return std::nullopt;
  return static_cast<double>(compliance.reached) / ended;
}

// A recording of corners with suggestions.csv says how its operator followed them, without a
// replay. Where a study calibrates some of the cameras only, a replay has to say it.
std::optional<double> recordedCompliance(const Step& step, const CalibrationRecord& record) {
  // The word after "calibrate" is the recording (Planner::addSource()); "{" begins the folder of a
  // step that detected its corners.
  if (step.words.size() < 2 || step.words[1].front() == '{') return std::nullopt;
  const std::string& recording = step.words[1];
  const auto file = findSuggestions(recording);
  if (!file) return std::nullopt;
  SessionReadOptions options;
  const auto target = std::ranges::find(step.words, "--target");
  if (target != step.words.end()) options.target_path = *(target + 1);
  try {
    const Session session = readSession(recording, options);
    if (session.cameras.size() != record.cameras().size()) return std::nullopt;
    return shareReached(operatorCompliance(session, readSuggestions(*file), record.cameras()));
  } catch (const InputError&) {
    return std::nullopt;  // a damaged suggestions.csv takes nothing from the calibration
  }
}

StudySession sessionOf(const Step& step, const CalibrationRecord& record) {
  StudySession row;
  row.name = step.session;
  row.compliance = recordedCompliance(step, record);
  row.verdict = record.verdict.level;
  row.verdict_sentence = worstFinding(record.verdict);
  if (const Finding* worst = gravest(record.verdict)) row.verdict_rule = worst->rule;
  double seconds = 0;
  if (const auto& camera = record.camera) {
    row.camera_rmse_px = camera->summary.reprojection.rmse_px;
    row.camera_entropy_nats = camera->summary.entropy_nats;
    seconds += camera->summary.seconds.total;
    // Only a board that was found to be bent is one of the session's own.
    const bool bent = camera->target_fit && camera->target_fit->finding == TargetFinding::kBent;
    if (bent) row.board = camera->target;
  }
  if (const auto& stage = record.camera_imu) {
    row.camera_imu_rmse_px = stage->summary.reprojection.rmse_px;
    row.camera_imu_entropy_nats = stage->summary.entropy_nats;
    row.time_offset_s = stage->imu.timeOffset();
    row.time_offset_std_s = stage->imu.time_offset_std_s;
    row.T_SC0 = stage->imu.T_SC0;
    row.T_SC0_std = stage->imu.T_SC0_std;
    seconds += stage->summary.seconds.total;
  }
  row.calibration_s = seconds;
  for (const Stage stage : {Stage::kCamera, Stage::kCameraImu}) {
    const auto estimates = parameterEstimates(record, stage);
    row.estimates.insert(row.estimates.end(), estimates.begin(), estimates.end());
  }
  return row;
}

StudyHeldOut heldOutOf(const Step& step, const CalibrationRecord& record) {
  StudyHeldOut row{step.session, step.part, std::nullopt, ""};
  // One calibration was evaluated on one recording.
  const CalibrationScore& score = record.held.value().scores.at(0);
  if (score.reprojection.count > 0) row.rmse_px = score.reprojection.rmse_px;
  row.failure = score.problem;
  return row;
}

/// A row an offset [ms]; a case that failed has its problem and no figure.
std::vector<StudyPerturbation> perturbationsOf(const Step& step, const PerturbationRecord& record) {
  std::vector<StudyPerturbation> rows;
  for (const PerturbationCase& c : record.cases) {
    StudyPerturbation row{step.session, c.amount, std::nullopt, c.problem};
    if (c.problem.empty()) {
      // Against the base's, which need not be zero: what is left is the injected offset.
      row.recovered_ms = 1e3 * (c.time_offset_s - record.base.time_offset_s);
    }
    rows.push_back(row);
  }
  return rows;
}

// Ours is the first calibration of the comparison, the other the second. In our deviations, by
// their degrees of freedom: few tools state their own, which the comparison's significance needs
// besides.
StudyOther otherOf(const Step& step, const ComparisonRecord& record) {
  StudyOther row{step.session, step.part, std::nullopt, {}, ""};
  for (const ComparedParameter& p : record.parameters) {
    if (p.difference.size() < 2 || !p.difference[1]) continue;
    const std::optional<double> std = p.std.empty() ? std::nullopt : p.std[0];
    row.differences.push_back({p.name, p.unit, *p.difference[1], std::nullopt});
    if (std && *std > 0) {
      const double d = *p.difference[1];
      row.differences.back().sigmas = std::copysign(normalDeviate(d, p.variance(0)), d);
    }
  }
  return row;
}

/// The RMSE of positions as `evaluate trajectory` states it, where that calls the run complete: as
/// of an odometry (trajectoriesOf()), an estimate of its easy part alone is no result.
StudyTrajectory trajectoryOf(const Step& step, const fs::path& folder) {
  const fs::path file = folder / "trajectory.json";
  try {
    const auto json = nlohmann::json::parse(MappedFile(file.string()).text());
    StudyTrajectory row = emptyTrajectory(step);
    if (json.at("status").get<std::string>() != toString(RunStatus::kComplete)) {
      row.failure = json.at("problem").get<std::string>();
      return row;
    }
    row.ate_m = json.at("ate").at("translation_m").at("rmse").get<double>();
    return row;
  } catch (const nlohmann::json::exception& error) {
    throw badInput(file.string(), {InputFault::kSyntax, error.what()});
  }
}

/// Only complete runs have an ATE: one that covers a part would be judged on the easier remainder.
std::vector<StudyTrajectory> trajectoriesOf(const Step& step, const TrajectoryRecord& record) {
  std::vector<StudyTrajectory> rows;
  for (const TrajectoryRun& run : record.runs) {
    StudyTrajectory row{step.session, step.part, "", std::nullopt, run.problem};
    // A single run needs no number.
    if (record.runs.size() > 1) row.run = run.run;
    if (run.status == RunStatus::kComplete) row.ate_m = run.ate_translation_m.rmse;
    rows.push_back(row);
  }
  return rows;
}

}  // namespace

// Names of sequences hold no slash.
StudyTrajectory emptyTrajectory(const Step& step, const std::string& failure) {
  const auto slash = step.part.find('/');
  const std::string run = slash == std::string::npos ? "" : step.part.substr(slash + 1);
  return {step.session, step.part.substr(0, slash), run, std::nullopt, failure};
}

StudyRecord rowsOf(const Step& step, const fs::path& folder) {
  StudyRecord rows;
  const Store store(folder / kRecordsFile);
  switch (step.kind) {
    case StepKind::kCalibrate:
      rows.sessions = {sessionOf(step, store.load<CalibrationRecord>())};
      break;
    case StepKind::kEvaluate:
      rows.held_out = {heldOutOf(step, store.load<CalibrationRecord>())};
      break;
    case StepKind::kPerturb:
      rows.perturbations = perturbationsOf(step, store.load<PerturbationRecord>());
      break;
    case StepKind::kCompare:
      rows.others = {otherOf(step, store.load<ComparisonRecord>())};
      break;
    case StepKind::kTrajectory:
      rows.trajectories = {trajectoryOf(step, folder)};
      break;
    case StepKind::kOdometry:
      rows.trajectories = trajectoriesOf(step, store.load<TrajectoryRecord>());
      break;
    case StepKind::kReplay: {
      const auto compliance = store.load<ReplayRecord>().compliance;
      StudySession& row = rows.sessions.emplace_back();
      row.name = step.session;
      if (compliance) row.compliance = shareReached(*compliance);
      break;
    }
    case StepKind::kDetect:
    case StepKind::kBoard:
    case StepKind::kEstimate:
      break;
  }
  return rows;
}

}  // namespace plumbline
