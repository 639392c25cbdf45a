// SPDX-License-Identifier: BSD-3-Clause
#include <cassert>

#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/batch/camera_imu/stage.h"

namespace plumbline {
namespace {

/// Rejects the corners that an earlier result did not use. Residuals of a view ascend in corner_id
/// as its corners do.
void rejectUnused(const CameraImuStageResult& earlier, CameraImuProblem& problem) {
  for (const CornerResidual& r : earlier.residuals) {
    if (r.used) continue;
    const auto c = static_cast<std::size_t>(r.camera);
    const int index = earlier.frames[static_cast<std::size_t>(r.frame)].view[c];
    const PackedView view = problem.corners[c].view(index);
    for (int k = 0; k < view.count; ++k) {
      if (view.id[k] == r.corner_id) problem.corners[c].setWeight(index, k, 0);
    }
  }
}

/// Appends a stretch: its frames that the IMU links, cut loose from what stands before.
void append(const FrameStretch& stretch, const CameraImuStageResult& earlier,
            std::span<const ImuGap> gaps, const FrameSelectionOptions& choice,
            CameraImuProblem& problem, CameraImuEstimate& estimate) {
  std::vector<TimeNs> stamps;
  for (int k = 0; k < stretch.count; ++k) {
    stamps.push_back(earlier.frames[static_cast<std::size_t>(stretch.first + k)].t);
  }
  const FrameSelection selection = selectFrames(stamps, problem.samples, gaps, choice);
  if (selection.chosen.empty()) return;
  if (!problem.frames.empty()) problem.links.push_back(FrameLink::kBroken);
  problem.links.insert(problem.links.end(), selection.links.begin(), selection.links.end());
  for (const int k : selection.chosen) {
    const auto at = static_cast<std::size_t>(stretch.first + k);
    problem.frames.push_back(earlier.frames[at]);
    problem.weights.push_back(stretch.weight);
    estimate.states.push_back(earlier.states[at]);
  }
}

}  // namespace

Result<CameraImuStageResult> recalibrateCameraImu(const Session& session,
                                                  const CameraImuStageResult& earlier,
                                                  const std::vector<FrameStretch>& stretches,
                                                  const CameraImuOptions& options) {
  assert(session.imu);
  CameraImuProblem problem = makeProblem(session, options);
  rejectUnused(earlier, problem);
  CameraImuEstimate estimate;
  estimate.T_SC0 = earlier.imu.T_SC0;
  estimate.gravity_direction = earlier.gravity_F.normalized();
  estimate.time_offset_s = earlier.imu.time_offset_s;
  estimate.cameras = earlier.cameras;
  for (const double offset : earlier.imu.camera_time_offsets_s) {
    const double difference = offset - earlier.imu.time_offset_s;
    auto& own = estimate.offset_differences_s.emplace_back();
    if (difference != 0) own = difference;
  }
  const auto gaps = imuGaps(problem.samples, options.max_gap_intervals);
  const FrameSelectionOptions choice = selectionOptions(options, estimate.time_offset_s);
  for (const FrameStretch& stretch : stretches) {
    assert(stretch.first >= 0 && stretch.weight > 0);
    assert(stretch.first + stretch.count <= static_cast<int>(earlier.frames.size()));
    append(stretch, earlier, gaps, choice, problem, estimate);
  }
  if (problem.frames.size() < 2) {
    return Failure{FailureReason::kTooFewViews, "the stretches hold fewer than two linked frames",
                   "use longer stretches"};
  }
  const CameraImuSolution solution = solveFromSolution(problem, estimate, options);
  return stageResult(problem, solution, session, options);
}

}  // namespace plumbline
