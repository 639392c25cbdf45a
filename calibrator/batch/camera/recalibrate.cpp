// SPDX-License-Identifier: BSD-3-Clause
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/option_check.h"
#include "calibrator/batch/board/target.h"
#include "calibrator/batch/camera/stage.h"

namespace plumbline {

void ViewSelectionOptions::check() const {
  requireAtLeast(0, "select_views.threshold_bits", threshold_bits);
  requirePositive("select_views.stop_excess", stop_excess);
  requireAtLeast(2, "select_views.least_views", least_views);
}

void CameraStageOptions::check() const {
  MeasurementModel::check();
  if (filter == CornerFilter::kSigma) requirePositive("filter_sigmas", filter_sigmas);
  if (select_views) select_views->check();
  frames.check();
  requireAtLeast(1, "frames.min_corners", frames.min_corners);
  // A start is a homography, which four points determine.
  requireAtLeast(4, "min_start_corners", min_start_corners);
  requireAtLeast(1, "start_views", start_views);
  requirePositive("max_start_error", max_start_error);
  requirePositive("target_max_std", target_max_std);
  requireAtLeast(0, "common_error_share", common_error_share);
  if (target_degree != 2 && target_degree != 4) {
    throw InputError(fmt::format("target_degree is {}; expected 2 or 4", target_degree));
  }
  requireAtLeast(1, "threads", threads);
  requireAtLeast(1, "max_iterations", max_iterations);
  requirePositive("tolerance", tolerance);
}

void checkSession(const Session& session) {
  if (session.cameras.empty()) throw InputError("the session has no cameras to calibrate");
  for (const CameraStream& camera : session.cameras) {
    if (camera.resolution.width > 0 && camera.resolution.height > 0) continue;
    throw InputError(camera.name +
                     ": the image's resolution is unknown; state it in the camera's sensor.yaml");
  }
}

void checkCameras(const Session& session, const std::vector<CameraCalibration>& cameras) {
  if (cameras.size() == session.cameras.size()) return;
  throw InputError(fmt::format("calibrations of {} cameras were given, but the session has {}",
                               cameras.size(), session.cameras.size()));
}

CameraProblem problemOf(const std::vector<PackedCorners>& corners, std::vector<Frame> frames,
                        const CameraStageOptions& options) {
  CameraProblem problem;
  problem.corners = corners;
  problem.frames = std::move(frames);
  problem.pixel_sigma = options.pixel_sigma;
  problem.gram.cauchy_px = options.cauchy_px;
  problem.threads = options.threads;
  problem.common_error_share = options.common_error_share;
  return problem;
}

MinimiserOptions solverOptions(const CameraStageOptions& options) {
  return {.max_iterations = options.max_iterations, .tolerance = options.tolerance};
}

Eigen::VectorXd cameraDifference(const std::vector<CameraCalibration>& to,
                                 const std::vector<CameraCalibration>& from) {
  return cameraDifference(estimateOf(to), estimateOf(from));
}

Result<CameraStageResult> recalibrateCameras(const Session& session,
                                             const CameraStageResult& earlier,
                                             const std::vector<FrameSegment>& segments,
                                             const CameraStageOptions& options) {
  options.check();
  checkCameras(session, earlier.cameras);
  std::vector<PackedCorners> corners = usedCorners(session, earlier.frames, earlier.residuals);
  CameraProblem problem = problemOf(corners, {}, options);
  CameraEstimate estimate = estimateOf(earlier.cameras);
  for (const FrameSegment& segment : segments) {
    for (int f = segment.first; f < segment.first + segment.count; ++f) {
      problem.frames.push_back(earlier.frames[f]);
      // A segment that was drawn twice counts twice.
      problem.weights.push_back(segment.weight);
      estimate.T_C0F.push_back(earlier.T_FC0[f].inverse());
    }
  }
  // What was solved for on the whole is solved for on the part: the board's terms are free again.
  const CameraSolution solution =
      solveAgain(session, earlier, options, problem, std::move(estimate));
  if (problem.target) placeCorners(problem.target->grid, solution.estimate, corners);
  return stageResult(session, problem, solution, ResidualList::kDrop);
}

Result<ResampleSummary> resampleCameras(const Session& session, const CameraStageResult& earlier,
                                        const ResampleOptions& resample,
                                        const CameraStageOptions& options) {
  CameraStageOptions one_thread = options;
  // Draws run beside each other.
  one_thread.threads = 1;
  const auto solve = [&](const std::vector<FrameSegment>& segments) {
    const auto again = recalibrateCameras(session, earlier, segments, one_thread);
    if (!again || !again->summary.converged) return std::optional<Eigen::VectorXd>();
    return std::optional(cameraDifference(again->cameras, earlier.cameras));
  };
  return solveDraws(earlier.summary.covariance, static_cast<int>(earlier.frames.size()), resample,
                    "camera", solve);
}

}  // namespace plumbline
