// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cassert>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera_imu/stage.h"

namespace plumbline {
namespace {

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
