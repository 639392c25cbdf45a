// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera_imu/stage.h"

#include <algorithm>
#include <utility>

#include "calibrator/base/option_check.h"
#include "calibrator/initialise/screening.h"

namespace plumbline {
namespace {

/// The few steps of squared error that precede a robust loss; enough once a step is within ten
/// standard deviations.
constexpr MinimiserOptions kWarmStart{.max_iterations = 4, .tolerance = 10};

/// Views with used corners; residuals are grouped by frame, then camera.
int countUsedViews(const std::vector<CornerResidual>& residuals) {
  int views = 0;
  const CornerResidual* last = nullptr;
  for (const CornerResidual& r : residuals) {
    if (!r.used) continue;
    if (last == nullptr || r.frame != last->frame || r.camera != last->camera) ++views;
    last = &r;
  }
  return views;
}

/// All that is said of a solution but deviations.
CameraImuStageResult estimates(const CameraImuProblem& problem, const CameraImuSolution& solution,
                               const Session& session) {
  const CameraImuEstimate& e = solution.estimate;
  CameraImuStageResult result;
  result.imu.T_SC0 = e.T_SC0;
  result.imu.time_offsets = e.time_offsets;
  result.imu.gravity_m_s2 = problem.gravity_m_s2;
  result.imu.noise = problem.noise;
  result.imu.rostopic = session.imu->rostopic;
  // The size of gravity is given, its direction estimated.
  result.gravity_F = problem.gravity_m_s2 * e.gravity_direction;
  result.cameras = e.cameras;
  result.frames = problem.frames;
  result.states = e.states;
  result.imu_residuals = imuIntervalResiduals(problem, e, solution.weights);
  result.imu_summary = summarise(result.imu_residuals);
  result.summary.iterations = solution.iterations;
  result.summary.converged = solution.end == MinimiserEnd::kConverged;
  result.summary.cost = solution.normals.cost;
  // At the exposures, like the cost (targetInCamera()).
  result.residuals = cornerResiduals(problem, e);
  addReprojection(usedErrors(result.residuals, session.cameras.size()), session, result.summary);
  result.summary.views_used = countUsedViews(result.residuals);
  return result;
}

/// Rows: T_SC0 (6), time offset, then, if freed, all intrinsics and all T_C0Ci but camera 0's.
void fillCovariance(ParameterCovariance covariance, bool free_cameras,
                    CameraImuStageResult& result) {
  const Eigen::VectorXd deviations = covariance.standardDeviations();
  result.imu.T_SC0_std = Vector6d(deviations.head<6>());
  result.imu.time_offset_std_s = deviations(6);
  setCovariance(std::move(covariance), result.summary);
  if (!free_cameras) return;
  // Behind T_SC0 and the offset.
  Eigen::Index at = 7;
  for (std::size_t c = 0; c < result.cameras.size(); ++c) {
    const auto count = result.cameras[c].intrinsics.stacked().size();
    result.cameras[c].intrinsics_std = deviations.segment(at, count);
    at += count;
  }
  for (std::size_t c = 1; c < result.cameras.size(); ++c) {
    result.cameras[c].T_C0Ci_std = Vector6d(deviations.segment<6>(at));
    at += 6;
  }
}

}  // namespace

void CameraImuOptions::check() const {
  MeasurementModel::check();
  if (filter == CornerFilter::kSigma) requirePositive("filter_sigmas", filter_sigmas);
  requireAtLeast(0, "margin_s", margin_s);
  requireAtLeast(1, "max_gap_intervals", max_gap_intervals);
  requirePositive("max_interval_s", max_interval_s);
  frames.check();
  requireAtLeast(1, "frames.min_corners", frames.min_corners);
  requirePositive("max_start_rms_px", max_start_rms_px);
  requirePositive("max_translation_std_m", max_translation_std_m);
  requirePositive("max_rotation_std_rad", max_rotation_std_rad);
  requirePositive("max_offset_std_s", max_offset_std_s);
  // As cauchy_px (MeasurementModel).
  if (score_information_px.value_or(0) != 0) {
    requireAtLeast(1e-3, "score_information_px", *score_information_px);
  }
  requireAtLeast(1, "threads", threads);
  requireAtLeast(1, "max_iterations", max_iterations);
  requirePositive("tolerance", tolerance);
}

CameraImuProblem makeProblem(const Session& session, const CameraImuOptions& options) {
  options.check();
  CameraImuProblem problem;
  problem.corners = packCorners(session);
  problem.target = session.target;
  for (const CameraStream& camera : session.cameras) {
    auto& stamps = problem.view_stamps.emplace_back();
    for (const ImageView& view : camera.views) stamps.push_back(view.t);
  }
  problem.noise = options.noise.value_or(session.imu->noise);
  // Before the shift: spikes are told by the stamps of the recording. `recorded` keeps what is cut
  // off, by which its own pauses are told from those made here.
  problem.spikes = findSpikes(session.imu->samples, problem.noise);
  problem.recorded =
      shiftedSamples(withoutSpikes(session.imu->samples, problem.spikes), options.imu_shift_ns);
  problem.samples = withoutCutOff(problem.recorded, findCutOff(problem.recorded));
  problem.gravity_m_s2 = options.gravity_m_s2;
  problem.pixel_sigma = options.pixel_sigma;
  problem.gram.cauchy_px = options.cauchy_px;
  problem.free_cameras = options.free_cameras;
  problem.threads = options.threads;
  return problem;
}

CameraImuEstimate calibrationEstimate(const CameraImuStageResult& result) {
  return {
      {}, result.imu.T_SC0, result.gravity_F.normalized(), result.imu.time_offsets, result.cameras};
}

SolvedCameraImu solvedBatch(const Session& session, const CameraImuStageResult& result,
                            const CameraImuOptions& options) {
  SolvedCameraImu solved{makeProblem(session, options), calibrationEstimate(result)};
  CameraImuProblem& problem = solved.problem;
  problem.corners = usedCorners(session, result.frames, result.residuals);
  problem.frames = result.frames;
  solved.estimate.states = result.states;
  // Of the links results keep the residuals of the inertial ones. To select again, under the offset
  // found, could leave frames out.
  auto inertial = result.imu_residuals.begin();
  for (std::size_t k = 0; k + 1 < problem.frames.size(); ++k) {
    const bool joined =
        inertial != result.imu_residuals.end() && inertial->t == problem.frames[k].t;
    problem.links.push_back(joined ? FrameLink::kInertial : FrameLink::kBiasWalk);
    if (joined) ++inertial;
  }
  problem.weights.assign(problem.frames.size(), 1);
  return solved;
}

FrameSelectionOptions selectionOptions(const CameraImuOptions& options, double time_offset_s) {
  return {time_offset_s, options.margin_s, options.max_interval_s};
}

CameraImuSolution solveFrom(CameraImuProblem& problem, const CameraImuEstimate& start,
                            const CameraImuOptions& options) {
  if (options.cauchy_px <= 0) return solveFromSolution(problem, start, options);
  const GramOptions robust = problem.gram;
  problem.gram.cauchy_px = 0;
  const CameraImuSolution squared = solveCameraImu(problem, start, kWarmStart);
  problem.gram = robust;
  // Not converged is no failure here; off the samples is.
  if (squared.end == MinimiserEnd::kLeftDomain) return squared;
  CameraImuSolution out = solveFromSolution(problem, squared.estimate, options);
  out.iterations += squared.iterations;
  return out;
}

CameraImuSolution solveFromSolution(const CameraImuProblem& problem, const CameraImuEstimate& start,
                                    const CameraImuOptions& options) {
  return solveCameraImu(problem, start,
                        {.max_iterations = options.max_iterations, .tolerance = options.tolerance});
}

Result<CameraImuStageResult> stageResult(const CameraImuProblem& problem,
                                         const CameraImuSolution& solution, const Session& session,
                                         const CameraImuOptions& options) {
  if (solution.end == MinimiserEnd::kLeftDomain) return Failure{FailureCode::kOffsetLeftSamples};
  // A solver that ran out of steps is told of (summary.converged), not refused.
  auto covariance = cameraImuCovariance(problem, solution, options);
  if (!covariance) return covariance.failure();
  CameraImuStageResult result = estimates(problem, solution, session);
  fillCovariance(std::move(covariance).value(), problem.free_cameras, result);
  if (options.state_covariances) result.state_covariances = stateCovariances(problem, solution);
  return result;
}

Result<CameraImuStageResult> scoreResult(const CameraImuProblem& problem,
                                         const CameraImuSolution& solution,
                                         const Session& session) {
  if (solution.end == MinimiserEnd::kLeftDomain) return Failure{FailureCode::kOffsetLeftSamples};
  // With the calibration held no covariance tells of a start that went nowhere: the solver has to.
  if (solution.end == MinimiserEnd::kNoStep) return Failure{FailureCode::kNoDescent};
  return estimates(problem, solution, session);
}

}  // namespace plumbline
