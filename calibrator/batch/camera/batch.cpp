// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera/batch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/calibration.h"
#include "calibrator/base/parallel.h"
#include "calibrator/base/time.h"
#include "calibrator/base/transform.h"
#include "calibrator/batch/board/target.h"
#include "calibrator/batch/camera/model_choice.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/batch/camera/stage.h"
#include "calibrator/batch/corners.h"
#include "calibrator/camera/camera.h"
#include "calibrator/initialise/camera_poses.h"
#include "calibrator/initialise/screening.h"

namespace plumbline {
namespace {

/// Camera c's views in the problem's frames, at an estimate.
std::vector<PosedView> posedViews(const CameraProblem& problem, const CameraEstimate& estimate,
                                  std::size_t c) {
  const Transform T_CiC0 = estimate.T_C0Ci[c].inverse();
  std::vector<PosedView> views;
  for (std::size_t f = 0; f < problem.frames.size(); ++f) {
    const int view = problem.frames[f].view[c];
    if (view >= 0) views.push_back({view, T_CiC0 * estimate.T_C0F[f]});
  }
  return views;
}

constexpr int kMinUsedCorners = 4;  // what a frame needs for a pose
constexpr int kFilterRounds = 3;    // of CornerFilter::kSigma
constexpr double kWideLoss = 0.01;  // scale over the image's width
constexpr double kNearGrazing = 86 * kDegree;

void checkSession(const Session& session) {
  if (session.cameras.empty()) throw InputError("the session has no cameras to calibrate");
  for (const CameraStream& camera : session.cameras) {
    if (camera.resolution.width > 0 && camera.resolution.height > 0) continue;
    throw InputError(camera.name +
                     ": the image's resolution is unknown; state it in the camera's sensor.yaml");
  }
}

/// Throws InputError for a model that can be scored only.
void refuseModel(const std::string& camera, const CameraModelPair& model) {
  if (canBeCalibrated(model.projection, model.distortion)) return;
  throw InputError(camera + ": " +
                   unsupportedModelText(toString(model.projection), toString(model.distortion)));
}

/// Corners that an estimate puts beyond an angle from the optical axis, of lenses that end there.
std::vector<CornerPlace> cornersBeyond(const CameraProblem& problem, const CameraEstimate& estimate,
                                       double angle_rad) {
  std::vector<CornerPlace> places;
  for (std::size_t c = 0; c < problem.corners.size(); ++c) {
    if (!endsAtRightAngle(estimate.intrinsics[c])) continue;
    for (const PosedView& posed : posedViews(problem, estimate, c)) {
      for (const int k : beyondAngle(problem.corners[c].view(posed.view), posed.T_CF, angle_rad)) {
        places.push_back({c, posed.view, k});
      }
    }
  }
  return places;
}

/// Corners of tags that do not stand where their ids belong.
std::vector<CornerPlace> misplacedCorners(const AprilGrid& target, const CameraProblem& problem,
                                          const CameraEstimate& estimate) {
  std::vector<CornerPlace> places;
  for (std::size_t c = 0; c < problem.corners.size(); ++c) {
    const Intrinsics& lens = estimate.intrinsics[c];
    for (const PosedView& posed : posedViews(problem, estimate, c)) {
      const PackedView view = problem.corners[c].view(posed.view);
      // The tags are looked through only where something is wrong.
      if (falseCorners(lens, view, posed.T_CF).empty()) continue;
      for (const MisplacedTag& tag : findMisplacedTags(target, lens, view, posed.T_CF)) {
        for (const int k : cornersOfTag(view, tag.tag)) places.push_back({c, posed.view, k});
      }
    }
  }
  return places;
}

/// The problem and estimate with only the frames that `keep` names (ascending).
void keepFrames(const std::vector<int>& keep, CameraProblem& problem, CameraEstimate& estimate) {
  std::vector<Frame> frames;
  std::vector<double> weights;
  std::vector<Transform> poses;
  for (const int f : keep) {
    const auto i = static_cast<std::size_t>(f);
    frames.push_back(problem.frames[i]);
    poses.push_back(estimate.T_C0F[i]);
    if (!problem.weights.empty()) weights.push_back(problem.weights[i]);
  }
  problem.frames = std::move(frames);
  problem.weights = std::move(weights);
  estimate.T_C0F = std::move(poses);
}

/// Frames whose corners were not all but rejected.
std::vector<int> framesWithCorners(const CameraProblem& problem) {
  std::vector<int> keep;
  for (int f = 0; f < problem.frameCount(); ++f) {
    const Frame& frame = problem.frames[static_cast<std::size_t>(f)];
    double most = 0;
    for (std::size_t c = 0; c < frame.view.size(); ++c) {
      if (frame.view[c] < 0) continue;
      most = std::max(most, problem.corners[c].view(frame.view[c]).used());
    }
    if (most >= kMinUsedCorners) keep.push_back(f);
  }
  return keep;
}

void dropBareFrames(CameraProblem& problem, CameraEstimate& estimate) {
  const std::vector<int> keep = framesWithCorners(problem);
  if (static_cast<int>(keep.size()) < problem.frameCount()) keepFrames(keep, problem, estimate);
}

/// Solves over the frames that have corners; the others stay where they are.
CameraSolution solveWithoutBareFrames(const CameraProblem& problem, const CameraEstimate& start,
                                      const MinimiserOptions& solver) {
  const std::vector<int> keep = framesWithCorners(problem);
  CameraProblem some = problem;
  CameraEstimate at = start;
  keepFrames(keep, some, at);
  CameraSolution solution = solveCameraProblem(some, at, solver);
  std::vector<Transform> poses = start.T_C0F;
  for (std::size_t i = 0; i < keep.size(); ++i) {
    poses[static_cast<std::size_t>(keep[i])] = solution.estimate.T_C0F[i];
  }
  solution.estimate.T_C0F = std::move(poses);
  return solution;
}

/// Solves, with a loss so wide that it touches gross errors only first where the loss is robust:
/// its normal equations lead closer to the minimum from afar. Corners that stand near 90 degrees
/// take no part in the first solution, whose lens may be off by some degrees there. Frames that are
/// left without corners leave the problem.
CameraSolution solveFromAfar(const AprilGrid& target, std::vector<PackedCorners>& corners,
                             CameraProblem& problem, const CameraEstimate& start,
                             const CameraStageOptions& options) {
  const MinimiserOptions solver = solverOptions(options);
  const auto near_grazing = cornersBeyond(problem, start, kNearGrazing);
  weigh(near_grazing, 0, corners);
  // Roughly: it only leads to where the loss that was asked for takes over.
  MinimiserOptions rough = solver;
  rough.cost_tolerance = 1e-3;
  const double wide_px = kWideLoss * rmsWidth(problem, start);
  problem.gram.cauchy_px = std::max(wide_px, options.cauchy_px);
  CameraSolution wide{start, {}, false, 0};
  // A squared error without corners to be spared is solved for at once.
  if (options.cauchy_px > 0 || !near_grazing.empty()) {
    wide = solveWithoutBareFrames(problem, start, rough);
  }
  weigh(near_grazing, 1, corners);
  weigh(cornersBeyond(problem, wide.estimate, kGrazing), 0, corners);
  weigh(misplacedCorners(target, problem, wide.estimate), 0, corners);
  problem.gram.cauchy_px = options.cauchy_px;
  dropBareFrames(problem, wide.estimate);
  CameraSolution robust = solveCameraProblem(problem, wide.estimate, solver);
  robust.iterations += wide.iterations;
  return robust;
}

std::size_t rejectAboveSigma(std::vector<PackedCorners>& corners, const CameraProblem& problem,
                             const CameraEstimate& estimate, double sigmas) {
  std::size_t count = 0;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    count += rejectAboveSigma(corners[c], estimate.intrinsics[c], posedViews(problem, estimate, c),
                              sigmas);
  }
  return count;
}

/// Each view by its own pose, refined alone: the joint solution is only where that starts.
std::size_t rejectLikeKalibr(std::vector<PackedCorners>& corners, const CameraProblem& problem,
                             const CameraEstimate& estimate) {
  std::size_t count = 0;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    for (const PosedView& posed : posedViews(problem, estimate, c)) {
      const auto rejected =
          kalibrOutliers(estimate.intrinsics[c], corners[c].view(posed.view), posed.T_CF);
      for (const int k : rejected) corners[c].setWeight(posed.view, k, 0);
      count += rejected.size();
    }
  }
  return count;
}

/// A solution, with the lens models chosen where that is asked for.
struct ModelSolution {
  CameraSolution solution;
  std::vector<ModelChoice> choices;
  double choice_s = 0;
};
ModelSolution solveModels(const Session& session, std::vector<PackedCorners>& corners,
                          CameraProblem& problem, const CameraEstimate& start,
                          const CameraStageOptions& options, int most_parameters) {
  const AprilGrid& board = session.target;
  // Cameras that were given have their models.
  if (options.model_mode != ModelMode::kAuto || !options.start.empty()) {
    return {solveFromAfar(board, corners, problem, start, options), {}, 0};
  }
  const std::vector<PackedCorners> all = corners;
  const std::vector<Frame> all_frames = problem.frames;
  CameraSolution first = solveFromAfar(board, corners, problem, start, options);
  const Stopwatch watch;
  ChosenModels chosen = chooseModels(session, problem, first.estimate, options, most_parameters);
  const double choice_s = watch.seconds();
  if (!chosen.differ(first.estimate.intrinsics)) {
    return {std::move(first), std::move(chosen.choices), choice_s};
  }
  // Which corners a lens leaves out depends on its model.
  std::copy(all.begin(), all.end(), corners.begin());
  CameraEstimate other = first.estimate;
  other.intrinsics = std::move(chosen.lenses);
  other.T_C0F = start.T_C0F;
  // Frames that the first solution left out begin again where they stood, the others where it
  // ended; both lists have the same order.
  for (std::size_t f = 0, i = 0; f < all_frames.size() && i < problem.frames.size(); ++f) {
    if (all_frames[f].view == problem.frames[i].view) other.T_C0F[f] = first.estimate.T_C0F[i++];
  }
  problem.frames = all_frames;
  CameraSolution solution = solveFromAfar(board, corners, problem, other, options);
  solution.iterations += first.iterations;
  return {std::move(solution), std::move(chosen.choices), choice_s};
}

/// The stage's solver with lens models, the board's shape, view selection and corner filter around
/// it.
struct StageSolution : TargetSolution {
  std::vector<ModelChoice> models;
  double choice_s = 0;  ///< of them and of the board's shape
};
StageSolution solveStage(const Session& session, std::vector<PackedCorners>& corners,
                         CameraProblem& problem, const CameraEstimate& start,
                         const CameraStageOptions& options, int most_parameters) {
  const AprilGrid& board = session.target;
  StageSolution stage;
  ModelSolution flat = solveModels(session, corners, problem, start, options, most_parameters);
  stage.models = std::move(flat.choices);
  const Stopwatch watch;
  static_cast<TargetSolution&>(stage) =
      estimateTarget(board, problem, std::move(flat.solution), options);
  stage.choice_s = flat.choice_s + watch.seconds();
  CameraSolution& solution = stage.solution;
  const auto place = [&] {
    if (problem.target) placeCorners(problem.target->grid, solution.estimate, corners);
  };
  place();
  // Of all solutions, not of the last alone.
  int iterations = solution.iterations;
  // Of a known board the fit describes another solution, with terms of the recording's own.
  const bool fit_follows =
      stage.fit && solution.estimate.target && options.target != TargetMode::kKnown;
  const auto again = [&] {
    dropBareFrames(problem, solution.estimate);
    if (problem.frames.empty()) return;
    solution = solveCameraProblem(problem, solution.estimate, solverOptions(options));
    if (fit_follows) describeBoard(problem, solution, *stage.fit);
    place();
    iterations += solution.iterations;
  };
  // After model and board: under wrong ones the corners to cut off would be those at the border of
  // the image and of the board, which tell most.
  if (options.filter == CornerFilter::kKalibr) {
    if (rejectLikeKalibr(corners, problem, solution.estimate) > 0) again();
  } else if (options.filter == CornerFilter::kSigma) {
    for (int round = 0; round < kFilterRounds; ++round) {
      if (rejectAboveSigma(corners, problem, solution.estimate, options.filter_sigmas) == 0) break;
      again();
    }
  }
  if (options.select_views && !problem.frames.empty()) {
    keepFrames(selectFrames(problem, solution.estimate, *options.select_views), problem,
               solution.estimate);
    again();
  }
  solution.iterations = iterations;
  return stage;
}

/// From a start to all that is reported; `corners` by value, for their weights change. `choices`
/// become those of the lens models, also where it fails.
Result<CameraStageResult> solveAndReport(const Session& session, std::vector<PackedCorners> corners,
                                         const CameraStart& start,
                                         const CameraStageOptions& options, int most_parameters,
                                         std::vector<ModelChoice>& choices) {
  Stopwatch watch;
  CameraProblem problem = problemOf(corners, start.frames, options);
  StageSolution solved =
      solveStage(session, corners, problem, start.estimate, options, most_parameters);
  const double solve_s = watch.lap();
  choices = std::move(solved.models);
  if (problem.frames.empty()) {
    const bool filtered = options.filter != CornerFilter::kNone || options.select_views;
    return Failure{filtered ? FailureCode::kFilterLeftNoFrame : FailureCode::kNoFramePose,
                   {{"frames", start.frames.size()}}};
  }
  auto result = stageResult(session, problem, solved.solution, ResidualList::kKeep);
  if (!result) return result;
  result.value().target_fit = solved.fit;
  result.value().models = choices;
  StageSeconds& seconds = result.value().summary.seconds;
  seconds.solve = solve_s - solved.choice_s;
  seconds.checks = solved.choice_s;
  seconds.covariance = watch.lap();
  return result;
}

/// Whether the recording may yet determine other lens models.
bool isUndetermined(const Failure& failure) {
  return failure.reason() == FailureReason::kNotObservable ||
         failure.reason() == FailureReason::kNotConverged;
}

/// With the models that the session states, all of its cameras; `choices` say what was tried before
/// them. Empty where it states none, or they fail.
std::optional<CameraStageResult> solveAsStated(const Session& session,
                                               const std::vector<PackedCorners>& corners,
                                               const std::vector<Frame>& frames,
                                               CameraStageOptions options,
                                               std::vector<ModelChoice> choices) {
  options.model_mode = ModelMode::kGiven;
  options.models.clear();
  for (const CameraStream& stream : session.cameras) {
    const auto stated = statedModel(stream);
    if (!stated || !canBeCalibrated(stated->projection, stated->distortion)) return std::nullopt;
    options.models.push_back(*stated);
  }
  const auto start = startFromViews(session, corners, frames, options.models, options);
  if (!start) return std::nullopt;
  std::vector<ModelChoice> none;
  auto result = solveAndReport(session, corners, *start, options, kMaxIntrinsics, none);
  if (!result) return std::nullopt;
  for (std::size_t c = 0; c < choices.size(); ++c) {
    choices[c].projection = options.models[c].projection;
    choices[c].distortion = options.models[c].distortion;
    choices[c].reason = ModelReason::kNotTested;
  }
  result.value().models = std::move(choices);
  return std::move(result).value();
}

/// ModelMode::kAuto. A short recording may not determine the models that predict it best: then
/// those of no more than the usual parameters are tried, and at last the ones that the session
/// states.
Result<CameraStageResult> chooseAndReport(const Session& session,
                                          const std::vector<PackedCorners>& corners,
                                          const std::vector<Frame>& frames,
                                          const CameraStart& start,
                                          const CameraStageOptions& options) {
  std::vector<ModelChoice> first, usual;
  auto result = solveAndReport(session, corners, start, options, kMaxIntrinsics, first);
  if (result.ok() || !isUndetermined(result.failure())) return result;
  result = solveAndReport(session, corners, start, options, kUsualParameters, usual);
  if (result.ok()) addCandidates(first, result.value().models);
  if (result.ok() || !isUndetermined(result.failure())) return result;
  auto stated = solveAsStated(session, corners, frames, options, std::move(first));
  return stated ? Result<CameraStageResult>(std::move(*stated)) : result;
}

}  // namespace

std::optional<CameraModelPair> statedModel(const CameraStream& stream) {
  if (stream.camera_model.empty() && stream.distortion_model.empty()) return std::nullopt;
  CameraModelPair pair;
  if (!stream.camera_model.empty()) {
    const auto projection = projectionModelFrom(stream.camera_model);
    if (!projection) throw InputError(stream.name + ": unknown model " + stream.camera_model);
    pair.projection = *projection;
  }
  // They describe the distortion themselves.
  const bool bare =
      pair.projection == ProjectionModel::kEucm || pair.projection == ProjectionModel::kDs;
  if (bare) pair.distortion = DistortionModel::kNone;
  if (!stream.distortion_model.empty()) {
    const auto distortion = distortionModelFrom(stream.distortion_model);
    if (!distortion) throw InputError(stream.name + ": unknown model " + stream.distortion_model);
    pair.distortion = *distortion;
  }
  return pair;
}

std::vector<CameraModelPair> cameraModels(const Session& session,
                                          const CameraStageOptions& options) {
  const std::size_t n = session.cameras.size();
  if (!options.models.empty() && options.models.size() != n) {
    throw InputError(
        fmt::format("models for {} cameras were given, but the session has {}; give "
                    "one per camera",
                    options.models.size(), n));
  }
  std::vector<CameraModelPair> models = options.models;
  for (std::size_t c = models.size(); c < n; ++c) {
    models.push_back(statedModel(session.cameras[c]).value_or(CameraModelPair()));
  }
  for (std::size_t c = 0; c < n; ++c) refuseModel(session.cameras[c].name, models[c]);
  return models;
}

Result<CameraStageResult> calibrateCameras(const Session& session,
                                           const CameraStageOptions& options) {
  options.check();
  checkSession(session);
  const Stopwatch total;
  Stopwatch watch;
  std::vector<PackedCorners> corners = packCorners(session);
  if (options.target == TargetMode::kKnown) {
    // Corners stand on the board's own shape from the beginning, but for tag_edge: that in the file
    // is of another recording.
    CameraEstimate known;
    known.target = startTerms(session.target, options.target);
    placeCorners(session.target, known, corners);
  }
  const std::vector<Frame> frames = pairFrames(session.cameras, options.frames);
  if (!options.start.empty()) checkCameras(session, options.start);
  for (const CameraCalibration& camera : options.start) {
    refuseModel(camera.name,
                {camera.intrinsics.projection_model, camera.intrinsics.distortion_model});
  }
  // A start has its models: nothing is chosen, and the session's words do not count.
  const bool choose = options.model_mode == ModelMode::kAuto && options.start.empty();
  std::vector<CameraModelPair> models;
  if (!choose && options.start.empty()) models = cameraModels(session, options);
  auto start = options.start.empty() ? startFromViews(session, corners, frames, models, options)
                                     : startFromCameras(options.start, corners, frames, options);
  if (!start) return start.failure();
  const double initialise_s = watch.lap();
  std::vector<ModelChoice> none;
  auto result = choose ? chooseAndReport(session, corners, frames, *start, options)
                       : solveAndReport(session, corners, *start, options, kMaxIntrinsics, none);
  if (!result) return result;
  StageSeconds& seconds = result.value().summary.seconds;
  seconds.initialise = initialise_s;
  seconds.total = total.seconds();
  return result;
}

Result<CameraStageResult> scoreCameras(const Session& session,
                                       const std::vector<CameraCalibration>& cameras,
                                       const CameraStageOptions& options) {
  options.check();
  checkSession(session);
  checkCameras(session, cameras);
  Stopwatch watch;
  std::vector<PackedCorners> corners = packCorners(session);
  auto start =
      startFromCameras(cameras, corners, pairFrames(session.cameras, options.frames), options);
  if (!start) return start.failure();
  CameraProblem problem = problemOf(corners, std::move(start.value().frames), options);
  CameraEstimate estimate = std::move(start.value().estimate);
  const double initialise_s = watch.lap();
  RefinedPoses poses = refinePoses(problem, estimate);
  // Not those beyond kGrazing: which they are depends on the lens, and a bad one would gain by it.
  const auto misplaced = misplacedCorners(session.target, problem, estimate);
  weigh(misplaced, 0, corners);
  if (!misplaced.empty()) poses = refinePoses(problem, estimate);
  std::size_t rejected = 0;
  if (options.filter == CornerFilter::kKalibr) {
    rejected = rejectLikeKalibr(corners, problem, estimate);
  } else if (options.filter == CornerFilter::kSigma) {
    rejected = rejectAboveSigma(corners, problem, estimate, options.filter_sigmas);
  }
  if (rejected > 0) {
    // Few corners are left where a filter took nearly all of them: no pose follows from those.
    const int frames = problem.frameCount();
    dropBareFrames(problem, estimate);
    if (problem.frames.empty()) return Failure{FailureCode::kNoFramePose, {{"frames", frames}}};
    poses = refinePoses(problem, estimate);
  }
  CameraStageResult result = resultFrom(session, problem, estimate);
  addResiduals(session, problem, estimate, ResidualList::kKeep, result);
  result.summary.converged = poses.converged;
  result.summary.cost = poses.total(problem.pixel_sigma);
  result.summary.seconds.initialise = initialise_s;
  result.summary.seconds.solve = watch.lap();
  result.summary.seconds.total = initialise_s + result.summary.seconds.solve;
  return result;
}

}  // namespace plumbline
