// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "evaluate/metrics/verdict.h"
#include "evaluate/results/progress.h"
#include "report/records/calibration_record.h"
#include "report/records/comparison_record.h"

namespace plumbline {

/// A calibration to be scored on a session, its cameras in the session's order and resolution
/// (matchCalibration()).
struct ScoredCalibration {
  std::string label;
  Calibration calibration;
};

struct ScoreOptions {
  CameraStageOptions camera;    ///< noise, loss, filter, frames; models and start do not matter
  CameraImuOptions camera_imu;  ///< likewise
  bool use_imu = true;          ///< score the camera-IMU part where both sides have one
  /// Entropies weight the corners by the stages' loss; false: all alike, so that two calibrations
  /// are judged by the same corners.
  bool entropy_under_loss = true;
  /// 2 or more: also K-fold validation, see scoreSession().
  int folds = 0;

  /// Throws InputError for values out of range.
  void check() const;
};

/// A calibration's scores on a session, and what its poses and states are there.
struct SessionScores {
  std::vector<CalibrationScore> scores;
  std::optional<CameraStageResult> camera;         ///< of the whole session, the calibration fixed
  std::optional<CameraImuStageResult> camera_imu;  ///< likewise
};

/// Whether the program can estimate every camera's models; some it can only score.
bool canBeCalibrated(const Calibration& calibration);

/// The models of each camera.
std::vector<CameraModelPair> modelsOf(const std::vector<CameraCalibration>& cameras);

/// Options that calibrate anew with the calibration's models, but none of its values as a start:
/// these may have been estimated with corners that the new one must not have seen.
CameraStageOptions withModelsOf(const Calibration& calibration, CameraStageOptions options);

/// Scores a calibration on a session: of the cameras only the poses move (scoreCameras()), and with
/// IMU only states and gravity's direction (scoreCameraImu()); everything else is as the file says.
/// This compares calibrations fairly where the session is the same; their own in-sample errors do
/// not.
///
/// The first score is that of the whole session ("all"). With folds the session is recalibrated
/// K times with the calibration's models, each time without a run of consecutive frames (foldOf()):
/// for each fold its in-sample score and the score of the run that it did not see, then both pooled
/// over all folds ("all 5 folds"). What cannot be had (a pose of no frame; a model that can only be
/// scored) is said in CalibrationScore::problem.
SessionScores scoreSession(const ScoredCalibration& scored, const Session& session,
                           const ScoreOptions& options, const ProgressSink& progress);

/// The score of a session that the calibration has not seen, by the word of whoever asks: part
/// "all", held out.
CalibrationScore scoreHeldOut(const ScoredCalibration& scored, const Session& session,
                              const ScoreOptions& options);

/// The errors over the image of a calibration that was held fixed on a recording, by camera, with
/// the thresholds of a calibration's own verdict: of the cameras alone, then with the IMU; nothing
/// of a stage that is not there.
std::vector<Finding> judgeScored(const std::optional<CameraStageResult>& camera,
                                 const std::optional<CameraImuStageResult>& camera_imu);

/// That the board is taken as stated although this file of its shape lies beside the calibration. A
/// board of another shape shows as errors of the calibration: it must be said. Whether the
/// calibration was estimated with the file is not known.
Finding unusedShape(const std::string& file);

/// What was found of a calibration that was held fixed beside its scores.
struct HeldFindings {
  std::vector<Finding> mistakes;  ///< of convention and units (evaluate/lint)
  std::vector<Finding> tests;     ///< judgeHeldCameras(), and judgeHeldImu() where both have an IMU
};

/// What the scores of a calibration that was held fixed say: its errors over the image on the
/// recording, with the thresholds of a calibration's own verdict, and the scores that could not be
/// had. The headline leads with its RMSE on every session, held out where it is known to be.
/// For a record with `held`. `unused_shape` is the file of the board's shape that lies beside
/// the calibration, where the board was taken as stated all the same ("": none).
Verdict scoreVerdict(const CalibrationRecord& record, const std::string& unused_shape = "",
                     const HeldFindings& held = {});

}  // namespace plumbline
