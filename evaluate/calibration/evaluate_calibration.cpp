// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/calibration/evaluate_calibration.h"

#include <filesystem>
#include <limits>
#include <utility>

#include <fmt/core.h>

#include "datasets/calibration/calibration_reader.h"
#include "evaluate/session/check_session.h"
#include "evaluate/session/load_session.h"
#include "evaluate/session/match_cameras.h"

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
  record.assumptions = score.use_imu ? assumptionsOf(score.camera, score.camera_imu, loaded.session)
                                     : assumptionsOf(score.camera, score.camera_imu);
  record.target = loaded.session.target;
  record.counts = loaded.counts;
  return record;
}

}  // namespace

void EvaluateCalibrationRequest::check() const {
  load.check();
  score.check();
}

Result<CalibrationRecord> evaluateCalibration(const EvaluateCalibrationRequest& asked,
                                              const ProgressSink& progress) {
  asked.check();
  LoadRequest load = asked.load;
  load.others.push_back(asked.calibration);
  const std::string label = std::filesystem::path(asked.calibration).filename().string();
  const Calibration calibration = readCalibration(asked.calibration);
  const auto scoredOn = [&](const Session& session) {
    return ScoredCalibration{label, matchCalibration(calibration, asked.calibration, session)};
  };
  const LoadedSession loaded = loadSession(load, progress);
  const ScoredCalibration scored = scoredOn(loaded.session);
  checkTargetLayout(loaded, {});
  SessionScores on_session = scoreSession(scored, loaded.session, asked.score, progress);
  const CalibrationScore& whole = on_session.scores.front();
  if (whole.reprojection.count == 0) {
    return Failure{
        FailureCode::kNoScore,
        {{"calibration", label}, {"session", whole.session}, {"problem", whole.problem}}};
  }
  CalibrationRecord record = recordOf(loaded, asked);
  record.camera = std::move(on_session.camera);
  record.camera_imu = std::move(on_session.camera_imu);
  record.held = HeldCalibration{label, std::move(on_session.scores)};
  for (const std::string& folder : asked.held_out) {
    const LoadedSession other = loadSession(loadOf(folder, asked.load), progress);
    progress("scoring " + other.session.name, -1);
    record.held->scores.push_back(
        scoreHeldOut(scoredOn(other.session), other.session, asked.score));
  }
  return record;
}

}  // namespace plumbline
