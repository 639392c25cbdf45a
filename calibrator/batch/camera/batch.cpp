// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera/batch.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/time.h"
#include "calibrator/base/transform.h"
#include "calibrator/batch/board/target.h"
#include "calibrator/batch/camera/model_choice.h"
#include "calibrator/batch/camera/stage.h"
#include "calibrator/initialise/view_screening.h"

namespace plumbline {
namespace {

constexpr int kFilterRounds = 3;    // of CornerFilter::kSigma
constexpr double kWideLoss = 0.01;  // scale over rmsWidth(), one for all cameras
constexpr double kNearGrazing = 86 * kDegree;

/// Throws InputError for a model that can be scored only.
void refuseModel(const std::string& camera, const CameraModelPair& model) {
  if (canBeCalibrated(model.projection, model.distortion)) return;
  throw InputError(camera + ": " +
                   unsupportedModelText(toString(model.projection), toString(model.distortion)));
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
    poses[keep[i]] = solution.estimate.T_C0F[i];
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
  double choice_s = 0;               ///< of them and of the board's shape
  std::size_t before_selection = 0;  ///< frames; 0 where none was asked for
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
  const int rounds = options.filter == CornerFilter::kSigma ? kFilterRounds : 1;
  for (int round = 0; round < rounds; ++round) {
    if (rejectCorners(problem, solution.estimate, options, corners) == 0) break;
    again();
  }
  if (options.select_views && !problem.frames.empty()) {
    stage.before_selection = problem.frames.size();
    keepFrames(selectFrames(problem, solution.estimate, *options.select_views), problem,
               solution.estimate);
    again();
  }
  solution.iterations = iterations;
  return stage;
}

/// A failure of what a selection left may be one of the selection; that a solution does not
/// converge is not one of too few frames.
Failure withSelection(Failure failure, std::size_t frames, std::size_t before) {
  if (frames >= before || failure.code == FailureCode::kCamerasNotConverged) return failure;
  failure.values.emplace("selected_frames", frames);
  failure.values.emplace("selected_from", before);
  return failure;
}

/// All that is reported, and the choices of lens models also where it fails.
struct CameraAttempt {
  Result<CameraStageResult> result;
  std::vector<ModelChoice> choices;
};

/// From a start; `corners` by value, for their weights change.
CameraAttempt solveAndReport(const Session& session, std::vector<PackedCorners> corners,
                             const CameraStart& start, const CameraStageOptions& options,
                             int most_parameters = kMaxIntrinsics) {
  Stopwatch watch;
  CameraProblem problem = problemOf(corners, start.frames, options);
  StageSolution solved =
      solveStage(session, corners, problem, start.estimate, options, most_parameters);
  const double solve_s = watch.lap();
  if (problem.frames.empty()) {
    const bool filtered = options.filter != CornerFilter::kNone || options.select_views;
    return {Failure{filtered ? FailureCode::kFilterLeftNoFrame : FailureCode::kNoFramePose,
                    {{"frames", start.frames.size()}}},
            std::move(solved.models)};
  }
  auto result = stageResult(session, problem, solved.solution, ResidualList::kKeep);
  if (!result) {
    return {withSelection(result.failure(), problem.frames.size(), solved.before_selection),
            std::move(solved.models)};
  }
  result.value().target_fit = solved.fit;
  result.value().models = solved.models;
  StageSeconds& seconds = result.value().summary.seconds;
  seconds.solve = solve_s - solved.choice_s;
  seconds.checks = solved.choice_s;
  seconds.covariance = watch.lap();
  return {std::move(result), std::move(solved.models)};
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
  auto result = solveAndReport(session, corners, *start, options).result;
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
  CameraAttempt first = solveAndReport(session, corners, start, options);
  if (first.result.ok() || !isUndetermined(first.result.failure())) return std::move(first.result);
  auto result = solveAndReport(session, corners, start, options, kUsualParameters).result;
  if (result.ok()) addCandidates(first.choices, result.value().models);
  if (result.ok() || !isUndetermined(result.failure())) return result;
  auto stated = solveAsStated(session, corners, frames, options, std::move(first.choices));
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
  auto result = choose ? chooseAndReport(session, corners, frames, *start, options)
                       : solveAndReport(session, corners, *start, options).result;
  if (!result) return result;
  StageSeconds& seconds = result.value().summary.seconds;
  seconds.initialise = initialise_s;
  seconds.total = total.seconds();
  return result;
}

}  // namespace plumbline
