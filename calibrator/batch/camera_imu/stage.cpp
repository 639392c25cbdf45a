// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera_imu/stage.h"

#include <algorithm>
#include <cassert>
#include <string>
#include <utility>

#include "calibrator/base/option_check.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera_imu/frame_selection.h"
#include "calibrator/initialise/sample_screening.h"

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

/// Appends a segment: its frames that the IMU links, cut loose from what stands before.
void append(const FrameSegment& segment, const CameraImuStageResult& earlier,
            std::span<const ImuGap> gaps, const FrameSelectionOptions& choice,
            CameraImuProblem& problem, CameraImuEstimate& estimate) {
  std::vector<TimeNs> stamps;
  for (int k = 0; k < segment.count; ++k) {
    stamps.push_back(earlier.frames[segment.first + k].t);
  }
  // Segment by segment: a frame whose only neighbours stand in another segment has no link here.
  const FrameSelection selection = selectFrames(stamps, problem.samples, gaps, choice);
  if (selection.chosen.empty()) return;
  if (!problem.frames.empty()) problem.links.push_back(FrameLink::kBroken);
  problem.links.insert(problem.links.end(), selection.links.begin(), selection.links.end());
  for (const int k : selection.chosen) {
    const int at = segment.first + k;
    problem.frames.push_back(earlier.frames[at]);
    problem.weights.push_back(segment.weight);
    estimate.states.push_back(earlier.states[at]);
  }
}

/// The cameras of a draw go with the board of that draw: corners are placed on it.
void hold(const HeldCameras& held, CameraImuProblem& problem, CameraImuEstimate& estimate) {
  estimate.cameras = held.cameras;
  problem.target.shape = held.target;
  for (PackedCorners& camera : problem.corners) camera.place(problem.target);
}

void append(std::vector<double>& to, const Eigen::VectorXd& values) {
  to.insert(to.end(), values.begin(), values.end());
}

/// Parameters of `to` minus those of `from`, in the order of the stage's covariance.
Eigen::VectorXd difference(const CameraImuStageResult& to, const CameraImuStageResult& from,
                           bool free_cameras) {
  std::vector<double> d;
  append(d, boxminus(to.imu.T_SC0, from.imu.T_SC0));
  d.push_back(to.imu.timeOffset() - from.imu.timeOffset());
  if (free_cameras) append(d, cameraDifference(to.cameras, from.cameras));
  const std::vector<std::string>& names = from.summary.covariance.names;
  for (std::size_t c = 0; c < from.cameras.size(); ++c) {
    // By the names of the earlier result: which cameras have an offset of their own is its choice.
    const std::string name = "time_offset." + parameterOwner(from.cameras, c);
    if (std::find(names.begin(), names.end(), name) == names.end()) continue;
    d.push_back(to.imu.timeOffset(c) - from.imu.timeOffset(c));
  }
  return Eigen::Map<const Eigen::VectorXd>(d.data(), d.size());
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

Result<CameraImuStageResult> recalibrateCameraImu(const Session& session,
                                                  const CameraImuStageResult& earlier,
                                                  const std::vector<FrameSegment>& segments,
                                                  const CameraImuOptions& options,
                                                  const std::optional<HeldCameras>& held) {
  assert(session.imu);
  CameraImuProblem problem = makeProblem(session, options);
  problem.corners = usedCorners(session, earlier.frames, earlier.residuals);
  CameraImuEstimate estimate = calibrationEstimate(earlier);
  if (held) hold(*held, problem, estimate);
  const auto gaps = imuGaps(problem.samples, options.max_gap_intervals);
  const FrameSelectionOptions choice = selectionOptions(options, estimate.timeOffset());
  for (const FrameSegment& segment : segments) {
    assert(segment.first >= 0 && segment.weight > 0);
    assert(segment.first + segment.count <= static_cast<int>(earlier.frames.size()));
    append(segment, earlier, gaps, choice, problem, estimate);
  }
  if (problem.frames.size() < 2) return Failure{FailureCode::kTooFewLinkedFrames};
  // No warm start by squared errors: it would lead away from a solution under the loss.
  const CameraImuSolution solution = solveFromSolution(problem, estimate, options);
  return stageResult(problem, solution, session, options);
}

Result<ResampleSummary> resampleCameraImu(const Session& session,
                                          const CameraImuStageResult& earlier,
                                          const ResampleOptions& resample,
                                          const CameraImuOptions& options,
                                          const DrawnCameras& cameras) {
  CameraImuOptions one_thread = options;
  // Draws run beside each other (solveDraws()).
  one_thread.threads = 1;
  const auto solve = [&](const std::vector<FrameSegment>& segments) {
    std::optional<HeldCameras> held;
    if (cameras) {
      held = cameras(segments);
      if (!held) return std::optional<Eigen::VectorXd>();
    }
    const auto again = recalibrateCameraImu(session, earlier, segments, one_thread, held);
    // A draw that has not converged would spread by where it stopped.
    if (!again || !again->summary.converged) return std::optional<Eigen::VectorXd>();
    return std::optional(difference(*again, earlier, options.free_cameras));
  };
  return solveDraws(earlier.summary.covariance, static_cast<int>(earlier.frames.size()), resample,
                    "camera-IMU", solve);
}

}  // namespace plumbline
