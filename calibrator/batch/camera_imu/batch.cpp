// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera_imu/batch.h"

#include <algorithm>
#include <utility>

#include "calibrator/base/calibration.h"
#include "calibrator/base/parallel.h"
#include "calibrator/base/time.h"
#include "calibrator/batch/camera_imu/frame_selection.h"
#include "calibrator/batch/camera_imu/posed_frames.h"
#include "calibrator/batch/camera_imu/stage.h"
#include "calibrator/initialise/camera_poses.h"
#include "calibrator/initialise/sample_screening.h"

namespace plumbline {
namespace {

constexpr int kMostSelections = 3;         // attempts to choose frames that stay on the samples
constexpr double kLeastMargin = 0.005;     // [s], from which it is widened
constexpr int kCameraImuFilterRounds = 2;  // of CornerFilter::kSigma
constexpr int kFewestFrames = 10;

std::optional<Failure> checkInputs(const Session& session,
                                   const std::vector<CameraCalibration>& cameras) {
  if (!session.imu || session.imu->samples.empty()) return Failure{FailureCode::kNoImu};
  if (cameras.size() != session.cameras.size()) {
    return Failure{FailureCode::kCameraCountDiffers,
                   {{"calibrated", cameras.size()}, {"session", session.cameras.size()}}};
  }
  return std::nullopt;
}

/// Why a selection leaves too few frames.
Failure tooFewSelected(const FrameSelection& selection, std::size_t frames,
                       const FrameSelectionOptions& choice) {
  Failure failure{FailureCode::kTooFewCoveredFrames,
                  {{"covered", selection.covered}, {"frames", frames}, {"needed", kFewestFrames}}};
  // Frames off the samples point to the clocks, frames without a neighbour to pauses.
  if (selection.covered < kFewestFrames) {
    failure.values.emplace("offset_s", choice.time_offset_s);
  } else {
    failure.code = FailureCode::kTooFewJoinedFrames;
    failure.values.emplace("joined", selection.chosen.size());
    failure.values.emplace("longest_s", choice.max_interval_s);
  }
  return failure;
}

struct SelectedSolution {
  CameraImuSolution solution;
  int frames_without_imu = 0;
  int gaps = 0;
};

/// Takes the selected frames into the problem; returns their poses.
std::vector<CameraPose> take(const FrameSelection& selection, const PosedFrames& posed,
                             CameraImuProblem& problem) {
  std::vector<CameraPose> poses;
  problem.frames.clear();
  for (const int i : selection.chosen) {
    problem.frames.push_back(posed.frames[i]);
    poses.push_back(posed.poses[i]);
  }
  problem.links = selection.links;
  problem.weights.assign(problem.frames.size(), 1);
  return poses;
}

/// A gyroscope that seems too slow may be cut off at the end of its range.
Failure withCutOff(Failure failure, std::span<const ImuSample> samples) {
  if (failure.code != FailureCode::kGyroscopeScale) return failure;
  // Channels 0 to 2 are the gyroscope's.
  for (const CutOff& channel : findCutOff(samples)) {
    if (channel.channel < 3) failure.values.insert_or_assign("cut_off_at", channel.limit);
  }
  return failure;
}

/// Pauses of the recorded samples between the first and the last frame.
int pausesWithin(const CameraImuProblem& problem, const CameraImuOptions& options,
                 double offset_s) {
  const auto pauses = imuGaps(problem.recorded, options.max_gap_intervals);
  const TimeNs from = problem.frames.front().t + toNanoseconds(offset_s);
  const TimeNs to = problem.frames.back().t + toNanoseconds(offset_s);
  return std::ranges::count_if(pauses,
                               [&](const ImuGap& gap) { return gap.to > from && gap.from < to; });
}

std::size_t rejectAboveSigma(CameraImuProblem& problem, const CameraImuEstimate& estimate,
                             double sigmas) {
  std::size_t count = 0;
  for (std::size_t c = 0; c < estimate.cameras.size(); ++c) {
    std::vector<PosedView> views;
    for (std::size_t i = 0; i < problem.frames.size(); ++i) {
      const int view = problem.frames[i].view[c];
      if (view >= 0) views.push_back({view, targetInCamera(problem, estimate, i, c)});
    }
    count += rejectAboveSigma(problem.corners[c], estimate.cameras[c].intrinsics, views, sigmas);
  }
  return count;
}

/// Rounds of rejection above sigma and renewed solution.
void filterAndSolve(CameraImuProblem& problem, CameraImuSolution& solution,
                    const CameraImuOptions& options) {
  for (int round = 0; round < kCameraImuFilterRounds; ++round) {
    if (rejectAboveSigma(problem, solution.estimate, options.filter_sigmas) == 0) return;
    // Iterations of all rounds, not of the last alone.
    const int before = solution.iterations;
    solution = solveFromSolution(problem, solution.estimate, options);
    solution.iterations += before;
  }
}

/// Chooses the frames under the first guess of the offset and solves; again with more margin should
/// the offset leave the samples; then the rounds of CornerFilter::kSigma.
Result<SelectedSolution> selectAndSolve(CameraImuProblem& problem, const PosedFrames& posed,
                                        const CameraImuStart& start,
                                        const std::vector<CameraCalibration>& cameras,
                                        const CameraImuOptions& options) {
  const auto gaps = imuGaps(problem.samples, options.max_gap_intervals);
  const auto stamps = posed.stamps();
  FrameSelectionOptions choice = selectionOptions(options, start.time_offsets.front().s);
  SelectedSolution out;
  // A wider margin leaves out the frames at the ends, which an offset that moved takes off the
  // samples: better a few frames less than no result.
  for (int attempt = 0; attempt < kMostSelections; ++attempt) {
    if (attempt > 0) choice.margin_s = 4 * std::max(choice.margin_s, kLeastMargin);
    const FrameSelection selection = selectFrames(stamps, problem.samples, gaps, choice);
    if (selection.chosen.size() < kFewestFrames) {
      return tooFewSelected(selection, stamps.size(), choice);
    }
    const auto poses = take(selection, posed, problem);
    // Of frames that have a pose; the others are counted by without_pose.
    out.frames_without_imu = static_cast<int>(stamps.size() - selection.chosen.size());
    out.gaps = pausesWithin(problem, options, start.time_offsets.front().s);
    out.solution = solveFrom(problem,
                             {startStates(poses, start), start.T_SC0, start.gravity_direction,
                              start.time_offsets, cameras},
                             options);
    if (out.solution.end != MinimiserEnd::kLeftDomain) break;
  }
  if (options.filter == CornerFilter::kSigma) filterAndSolve(problem, out.solution, options);
  return out;
}

/// By every view's own pose, that of the homography, before anything is refined.
void rejectLikeKalibr(std::vector<PackedCorners>& corners,
                      const std::vector<CameraCalibration>& cameras,
                      const std::vector<Frame>& frames, int threads) {
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const Intrinsics& lens = cameras[c].intrinsics;
    const auto found = parallelMap(frames.size(), threads, [&](std::size_t i) {
      const int view = frames[i].view[c];
      return view >= 0 ? homographyPose(lens, corners[c].view(view)) : std::nullopt;
    });
    std::vector<PosedView> starts;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      if (found[i]) starts.push_back({frames[i].view[c], *found[i]});
    }
    rejectLikeKalibr(corners[c], lens, starts, threads);
  }
}

/// The frames that have a pose. Corners that stand in the wrong place lose their weight in the
/// problem, then those that Kalibr's filter rejects, which comes before anything is refined.
Result<PosedFrames> posedFrames(const Session& session,
                                const std::vector<CameraCalibration>& cameras,
                                const CameraImuOptions& options, CameraImuProblem& problem) {
  PosedFrames posed = poseFrames(session, problem.corners, cameras, options);
  if (posed.frames.size() < kFewestFrames) {
    return Failure{FailureCode::kTooFewPosedFrames,
                   {{"frames", posed.frames.size()}, {"needed", kFewestFrames}}};
  }
  // Before any filter: what stands in the wrong place would spoil its limits.
  weigh(posed.rejected, 0, problem.corners);
  if (options.filter == CornerFilter::kKalibr) {
    rejectLikeKalibr(problem.corners, cameras, posed.frames, options.threads);
  }
  return posed;
}

/// All that was left out of the recording, with stamps as recorded.
void addLeftOut(const PosedFrames& posed, const CameraImuProblem& problem,
                const SelectedSolution& selected, const CameraImuOptions& options,
                CameraImuStageResult& result) {
  result.imu_rate_hz = 1 / medianSampleInterval(problem.samples);
  result.frames_without_pose = posed.without_pose;
  result.frames_without_imu = selected.frames_without_imu;
  result.imu_gaps = selected.gaps;
  result.screening = posed.screening;
  result.screening.spikes = problem.spikes;
  for (const ImuGap& gap : imuGaps(problem.recorded, options.max_gap_intervals)) {
    // The samples are shifted, the page speaks of the recording's stamps.
    result.screening.pauses.push_back(
        {gap.from - options.imu_shift_ns, secondsBetween(gap.from, gap.to)});
  }
}

void addDiagnosis(Diagnosis found, CameraImuStageResult& result) {
  result.faults = std::move(found.faults);
  if (!found.joint) return;
  result.summary.robust_std = std::move(found.joint->std);
  result.summary.robust_dof = std::move(found.joint->dof);
}

}  // namespace

Result<CameraImuStageResult> scoreCameraImu(const Session& session,
                                            const std::vector<CameraCalibration>& cameras,
                                            const ImuCalibration& imu,
                                            const CameraImuOptions& options) {
  if (const auto failure = checkInputs(session, cameras)) return *failure;
  const Stopwatch total;
  Stopwatch watch;
  CameraImuProblem problem = makeProblem(session, options);
  problem.free_cameras = false;
  problem.fixed_calibration = true;
  const auto posed = posedFrames(session, cameras, options, problem);
  if (!posed) return posed.failure();
  const CameraImuStart start = startFromCalibration(posed->poses, problem.samples, imu);
  StageSeconds seconds;
  seconds.initialise = watch.lap();
  auto selected = selectAndSolve(problem, *posed, start, cameras, options);
  if (!selected) return selected.failure();
  CameraImuSolution& solution = selected.value().solution;
  seconds.solve = watch.lap();
  seconds.total = total.seconds();
  auto result = scoreResult(problem, solution, session);
  if (!result) return result;
  result.value().imu.T_SC0 = imu.T_SC0;  // steps of length zero round
  addLeftOut(*posed, problem, *selected, options, result.value());
  result.value().summary.seconds = seconds;
  if (options.score_information_px) {
    // What the session tells of the calibration that was held.
    auto covariance = fixedCovariance(std::move(problem), solution, *options.score_information_px);
    if (covariance) setCovariance(std::move(*covariance), result.value().summary);
  }
  return result;
}

Result<CameraImuStageResult> calibrateCameraImu(const Session& session,
                                                const std::vector<CameraCalibration>& cameras,
                                                const CameraImuOptions& options) {
  if (const auto failure = checkInputs(session, cameras)) return *failure;
  const Stopwatch total;
  Stopwatch watch;
  CameraImuProblem problem = makeProblem(session, options);
  const auto posed = posedFrames(session, cameras, options, problem);
  if (!posed) return posed.failure();
  CameraImuOptions with_noise = options;
  // The alignment with gravity judges its residuals by the densities, the session's if the options
  // have none.
  with_noise.noise = problem.noise;
  auto start = startCameraImu(posed->poses, problem.samples, session.target, with_noise);
  if (!start) return withCutOff(start.failure(), problem.recorded);
  freeOwnOffsets(session, posed->frames, start.value().time_offsets);
  StageSeconds seconds;
  seconds.initialise = watch.lap();

  auto selected = selectAndSolve(problem, *posed, *start, cameras, options);
  if (!selected) return selected.failure();
  CameraImuSolution& solution = selected.value().solution;
  seconds.solve = watch.lap();

  // Before the residuals are listed: no other step takes as much memory.
  std::optional<Diagnosis> found;
  if (options.diagnose_faults) found = diagnoseFaults(problem, solution, options.cameras_given);
  seconds.checks = watch.lap();
  // Offsets that wander so far that no test at the optimum reaches them show in the rates alone.
  // Cameras of another recording are no explanation of them. Whoever asks for no tests is not
  // refused: the same recording may pass them.
  const bool explained = found && std::ranges::any_of(found->faults.causes, [](const FaultTest& t) {
                           return t.fault != UnmodelledFault::kGivenCameras;
                         });
  const auto wandering = wanderingStamps(start->parts);
  if (wandering && options.diagnose_faults && !explained) return *wandering;
  auto result = stageResult(problem, solution, session, options);
  if (!result) return result;
  seconds.covariance = watch.lap();
  addLeftOut(*posed, problem, *selected, options, result.value());
  if (found) addDiagnosis(std::move(*found), result.value());
  // Last: the check takes problem and solution over.
  if (options.noise_check) {
    const FrameErrors errors = frameErrors(problem, solution.estimate);
    result.value().frame_errors = errors;
    result.value().imu_summary.noise =
        checkImuNoise(std::move(problem), std::move(solution), errors.freeSigma());
  }
  seconds.checks += watch.lap();
  seconds.total = total.seconds();
  result.value().summary.seconds = seconds;
  result.value().inertial_check = start->check;
  return result;
}

}  // namespace plumbline
