// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/calibration/score.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/calibration.h"
#include "calibrator/base/error.h"
#include "calibrator/base/frames.h"
#include "calibrator/batch/camera/information.h"
#include "calibrator/batch/corners.h"
#include "evaluate/metrics/calibration/both_stages.h"
#include "evaluate/metrics/calibration/fold.h"
#include "evaluate/metrics/failure_text.h"

namespace plumbline {
namespace {

/// What a score was made of, kept so that folds can be pooled.
struct Scored {
  CalibrationScore score;
  CameraErrors camera;                                   ///< of the cameras alone
  CameraErrors camera_imu;                               ///< empty without IMU
  std::optional<CameraStageResult> camera_stage;         ///< of scoreMatched()
  std::optional<CameraImuStageResult> camera_imu_stage;  ///< likewise
};

void addReprojection(const CameraErrors& errors, CalibrationScore& score) {
  auto [all, per_camera] = summariseErrors(errors);
  score.reprojection = all;
  score.per_camera = std::move(per_camera);
}

void addCameraStage(const CameraStageResult& stage, Scored& out) {
  out.camera = usedErrors(stage.residuals, stage.cameras.size());
  addReprojection(out.camera, out.score);
  out.score.views_used = stage.summary.views_used;
  out.score.views_offered = stage.summary.views_offered;
}

void addImuStage(const CameraImuStageResult& stage, Scored& out) {
  out.camera_imu = usedErrors(stage.residuals, stage.cameras.size());
  out.score.camera_imu = summariseErrors(out.camera_imu).reprojection;
  out.score.camera_imu_cost = stage.summary.cost;
  out.score.gyro_rms_rad_s = stage.imu_summary.gyro_rms_rad_s;
  out.score.accel_rms_m_s2 = stage.imu_summary.accel_rms_m_s2;
}

/// Entropy of the calibration's own parameters, at their values.
void addEntropy(const Session& session, const ScoreOptions& options, Scored& out) {
  CameraInformationOptions weights;
  weights.model() = options.camera.model();
  // Without a loss all corners weigh alike, under whatever calibration: then entropies compare.
  if (!options.entropy_under_loss) weights.cauchy_px = 0;
  weights.threads = options.camera.threads;
  StageSummary& summary = out.camera_stage->summary;
  const auto information = cameraInformation(session, *out.camera_stage, weights);
  if (!information) return;
  summary.covariance = information->covariance;
  summary.entropy_nats = information->entropy_nats;
  out.score.entropy_nats = information->entropy_nats;
  out.score.entropy_parameters = information->covariance.names;
}

/// One more thing that a score lacks, behind what is said already.
void addProblem(const std::string& more, CalibrationScore& score) {
  if (!more.empty()) score.problem += (score.problem.empty() ? "" : "; ") + more;
}

/// Camera and IMU, the calibration fixed, and the entropy of T_SC0 and the offset with it.
void addHeldImu(const Session& session, const Calibration& calibration, const ScoreOptions& options,
                Scored& out) {
  CameraImuOptions fixed = options.camera_imu;
  // 0: no loss (ScoreOptions::entropy_under_loss).
  fixed.score_information_px = options.entropy_under_loss ? fixed.cauchy_px : 0;
  auto imu = scoreCameraImu(session, calibration.cameras, *calibration.imu, fixed);
  // Figures of one that has not converged would be those of where it stopped.
  if (!imu || !imu->summary.converged) {
    const std::string problem =
        imu ? fmt::format(
                  "with T_SC0 and the time offset as given, poses and biases did not "
                  "converge in {} iterations",
                  imu->summary.iterations)
            : problemOf(imu.failure());
    return addProblem("camera-IMU: " + problem, out.score);
  }
  addImuStage(*imu, out);
  if (!imu->summary.covariance.names.empty()) {
    out.score.camera_imu_entropy_nats = imu->summary.entropy_nats;
    out.score.camera_imu_entropy_parameters = imu->summary.covariance.names;
  }
  out.camera_imu_stage = std::move(imu).value();
}

CalibrationScore emptyScore(const std::string& label, const Session& session) {
  CalibrationScore score;
  score.label = label;
  score.session = session.name;
  score.part = "all";
  for (const CameraStream& camera : session.cameras) score.cameras.push_back(camera.name);
  return score;
}

bool hasCorners(const Session& session) {
  for (const CameraStream& camera : session.cameras) {
    for (const ImageView& view : camera.views) {
      if (!view.corners.empty()) return true;
    }
  }
  return false;
}

/// Poses alone, then, with IMU on both sides, states as well. What cannot be had ends it with a
/// problem; figures that are there by then stay.
Scored scoreMatched(const ScoredCalibration& scored, const Session& session,
                    const ScoreOptions& options) {
  const Calibration& calibration = scored.calibration;
  Scored out;
  out.score = emptyScore(scored.label, session);
  // Said apart: scoring would fail for want of poses, and its advice would be about layout and
  // models.
  if (!hasCorners(session)) {
    out.score.problem =
        "the session contains no corner of the target; check its images and target.yaml";
    return out;
  }
  auto cameras = scoreCameras(session, calibration.cameras, options.camera);
  if (!cameras) {
    out.score.problem = problemOf(cameras.failure());
    return out;
  }
  if (!cameras->summary.converged) out.score.problem = "the poses of some frames did not converge";
  addCameraStage(*cameras, out);
  out.camera_stage = std::move(cameras).value();
  addEntropy(session, options, out);
  if (options.use_imu && calibration.imu && session.imu) {
    addHeldImu(session, calibration, options, out);
  }
  return out;
}

/// In sample and held out, of one fold or pooled over several.
struct FoldScores {
  Scored in_sample, held_out;
};

/// Both scores of a fold that could not be calibrated, with the reason.
FoldScores failedFold(FoldScores scores, const std::string& problem) {
  scores.in_sample.score.problem = scores.held_out.score.problem = problem;
  return scores;
}

/// Why a fold could not be calibrated, and what to do. To record more, as a calibration of the
/// recording itself would be told to (textOf().cure), does not mend a fold of it, and options of
/// `calibrate` are not at hand.
std::string problemOfFold(const Failure& failure) {
  const FailureText text = textOf(failure);
  // Then the frames that the fold leaves out may be what is missing.
  if (failure.input() == FaultyInput::kSession &&
      failure.reason() != FailureReason::kNotConverged &&
      failure.reason() != FailureReason::kImplausible) {
    return text.message + "; with more --folds each leaves out less of the recording";
  }
  return text.cure.find("--") == std::string::npos ? problemOf(failure) : text.message;
}

/// Calibrates on the fold's training part, and scores the result on what was held out.
FoldScores scoreFold(const ScoredCalibration& scored, const Fold& fold,
                     const ScoreOptions& options) {
  const Calibration& calibration = scored.calibration;
  FoldScores out;
  out.in_sample.score = emptyScore(scored.label, fold.training);
  out.held_out.score = emptyScore(scored.label, fold.held_out);
  const auto cameras = calibrateCameras(fold.training, withModelsOf(calibration, options.camera));
  if (!cameras) return failedFold(std::move(out), problemOfFold(cameras.failure()));
  addCameraStage(*cameras, out.in_sample);
  out.in_sample.score.entropy_nats = cameras->summary.entropy_nats;
  out.in_sample.score.entropy_parameters = cameras->summary.covariance.names;
  // No IMU until the fold has one: the calibration's own was estimated with the frames held out.
  Calibration recalibrated{cameras->cameras, {}};
  if (options.use_imu && calibration.imu && fold.training.imu) {
    const auto imu = convergedCameraImu(fold.training, recalibrated.cameras, options.camera_imu);
    if (imu) {
      addImuStage(*imu, out.in_sample);
      recalibrated.imu = imu->imu;
    } else {
      // Held-out frames would else be scored by where it stopped.
      out = failedFold(std::move(out), "camera-IMU: " + problemOfFold(imu.failure()));
    }
  }
  // Also where the camera-IMU stage failed: then of the cameras alone, and the problem is kept.
  Scored held_out = scoreMatched({scored.label, recalibrated}, fold.held_out, options);
  addProblem(out.held_out.score.problem, held_out.score);
  out.held_out = std::move(held_out);
  return out;
}

void add(const CameraErrors& more, CameraErrors& errors) {
  errors.resize(std::max(errors.size(), more.size()));
  for (std::size_t c = 0; c < more.size(); ++c) {
    errors[c].insert(errors[c].end(), more[c].begin(), more[c].end());
  }
}

/// Errors corner by corner, so that the pooled RMSE is over corners; the first problem is kept.
void pool(const Scored& fold, Scored& sum) {
  add(fold.camera, sum.camera);
  add(fold.camera_imu, sum.camera_imu);
  sum.score.views_used += fold.score.views_used;
  sum.score.views_offered += fold.score.views_offered;
  if (sum.score.problem.empty() && !fold.score.problem.empty()) {
    sum.score.problem = fold.score.part + ": " + fold.score.problem;
  }
}

/// RMSE over the corners of all folds together, not the mean of their RMSEs: a fold with many
/// corners counts by them.
CalibrationScore pooled(Scored sum, const std::string& part, bool held_out) {
  addReprojection(sum.camera, sum.score);
  if (!sum.camera_imu.empty()) sum.score.camera_imu = summariseErrors(sum.camera_imu).reprojection;
  sum.score.part = part;
  sum.score.held_out = held_out;
  return std::move(sum.score);
}

void addFolds(const ScoredCalibration& scored, const Session& session, const ScoreOptions& options,
              const ProgressSink& progress, std::vector<CalibrationScore>& scores) {
  const Calibration& calibration = scored.calibration;
  FoldScores sum;
  sum.in_sample.score = sum.held_out.score = emptyScore(scored.label, session);
  for (int k = 0; k < options.folds; ++k) {
    progress("validating", static_cast<double>(k) / options.folds);
    // To cut the IMU's samples where the held-out frames are in its clock.
    // The calibration's own, as that of the fold is estimated after the cut.
    const double offset_s = calibration.imu ? calibration.imu->timeOffset() : 0;
    const Fold fold = foldOf(session, options.camera.frames, {k, options.folds, offset_s});
    FoldScores one = scoreFold(scored, fold, options);
    one.in_sample.score.part = one.held_out.score.part =
        fmt::format("fold {} of {}", k + 1, options.folds);
    one.held_out.score.held_out = true;
    pool(one.in_sample, sum.in_sample);
    pool(one.held_out, sum.held_out);
    scores.push_back(std::move(one.in_sample.score));
    scores.push_back(std::move(one.held_out.score));
  }
  const std::string all = fmt::format("all {} folds", options.folds);
  scores.push_back(pooled(std::move(sum.in_sample), all, false));
  scores.push_back(pooled(std::move(sum.held_out), all, true));
}

/// Why there is no K-fold validation; empty where there can be one.
std::string whyNoFolds(const Calibration& calibration, const Session& session,
                       const ScoreOptions& options) {
  if (!canBeCalibrated(calibration)) {
    return "its camera models can be scored but not calibrated: no K-fold validation";
  }
  const auto frames = static_cast<int>(pairFrames(session.cameras, options.camera.frames).size());
  // Two frames in every run that is held out, at least.
  if (frames >= 2 * options.folds) return {};
  return fmt::format("{} frames with corners are too few for {} folds", frames, options.folds);
}

}  // namespace

bool canBeCalibrated(const Calibration& calibration) {
  return std::all_of(calibration.cameras.begin(), calibration.cameras.end(),
                     [](const CameraCalibration& camera) {
                       return canBeCalibrated(camera.intrinsics.projection_model,
                                              camera.intrinsics.distortion_model);
                     });
}

std::vector<CameraModelPair> modelsOf(const std::vector<CameraCalibration>& cameras) {
  std::vector<CameraModelPair> models;
  for (const CameraCalibration& camera : cameras) {
    models.push_back({camera.intrinsics.projection_model, camera.intrinsics.distortion_model});
  }
  return models;
}

CameraStageOptions withModelsOf(const Calibration& calibration, CameraStageOptions options) {
  options.models = modelsOf(calibration.cameras);
  options.start.clear();
  return options;
}

void ScoreOptions::check() const {
  if (folds >= 0 && folds != 1) return;
  throw InputError(fmt::format("{} folds: expected 0 (none), or 2 and more", folds));
}

SessionScores scoreSession(const ScoredCalibration& scored, const Session& session,
                           const ScoreOptions& options, const ProgressSink& progress) {
  options.check();
  progress("scoring", -1);
  Scored whole = scoreMatched(scored, session, options);
  SessionScores out{{}, std::move(whole.camera_stage), std::move(whole.camera_imu_stage)};
  out.scores.push_back(std::move(whole.score));
  if (options.folds < 2) return out;
  const std::string why = whyNoFolds(scored.calibration, session, options);
  if (why.empty()) {
    addFolds(scored, session, options, progress, out.scores);
  } else {
    CalibrationScore none = emptyScore(scored.label, session);
    none.part = fmt::format("all {} folds", options.folds);
    none.held_out = true;
    none.problem = why;
    out.scores.push_back(std::move(none));
  }
  return out;
}

CalibrationScore scoreHeldOut(const ScoredCalibration& scored, const Session& session,
                              const ScoreOptions& options) {
  CalibrationScore score = scoreMatched(scored, session, options).score;
  score.held_out = true;
  return score;
}

}  // namespace plumbline
