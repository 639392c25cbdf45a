// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/imu_stage_tracker.h"

#include <utility>

#include <fmt/format.h>

#include "calibrator/batch/camera_imu/stage.h"

namespace plumbline {
namespace {

/// Of which frame a note speaks, unless it is the decision's own.
std::string prefix(const PosedFrame& frame, const Decision& decision) {
  return frame.t == decision.t ? "" : fmt::format("frame {}: ", frame.index);
}

void becauseOf(GuideReason reason, const PosedFrame& frame, Decision& decision) {
  if (frame.t == decision.t) decision.reason = reason;
}

}  // namespace

ImuStageTracker::ImuStageTracker(CameraImuWindow window, double max_gap_s)
    : window_(std::move(window)), max_gap_s_(max_gap_s), last_given_(window_.lastStamp()) {}

void ImuStageTracker::drain(ImuStageRecording& recording, Decision& decision) {
  // Frames wait until the samples reach them on the IMU's clock; 1 ns more for the rounding.
  const TimeNs offset = toNanoseconds(window_.estimate().timeOffset()) + 1;
  while (!pending_.empty() && recording.covers(pending_.front().t + offset)) {
    const PosedFrame frame = std::move(pending_.front());
    pending_.pop_front();
    enter(frame, recording, decision);
  }
}

FrameLink ImuStageTracker::linkTo(const PosedFrame& frame, const ImuStageRecording& recording,
                                  Decision& decision) const {
  const TimeNs offset = toNanoseconds(window_.estimate().timeOffset());
  // Pre-integration across a pause of the samples would take the rate between its ends as linear;
  // across one of the frames its noise would outgrow what it says. The biases walk on either way.
  const auto gap = recording.gapWithin(last_given_ + offset, frame.t + offset);
  const double apart_s = secondsBetween(last_given_, frame.t);
  if (!gap && apart_s <= max_gap_s_) return FrameLink::kInertial;
  if (frame.after_jump) becauseOf(GuideReason::kTimeJump, frame, decision);
  if (gap) becauseOf(GuideReason::kImuGap, frame, decision);
  const std::string pause = gap ? fmt::format("IMU samples pause for {:.3f} s before it", *gap)
                                : fmt::format("{:.3f} s after the last frame used", apart_s);
  note(decision, prefix(frame, decision) + pause + ": joined by the biases' walk alone");
  return FrameLink::kBiasWalk;
}

void ImuStageTracker::enter(const PosedFrame& frame, ImuStageRecording& recording,
                            Decision& decision) {
  const FrameLink link = linkTo(frame, recording, decision);
  last_given_ = frame.t;
  const WindowEnd end = window_.add({frame.t, frame.corners, frame.T_FC0, link});
  const std::optional<int> waiting = std::exchange(held_, std::nullopt);
  if (end == WindowEnd::kWaiting) {
    held_ = frame.index;
    note(decision, prefix(frame, decision) + "waits for the next frame to tell its velocity");
  }
  if (end == WindowEnd::kSolved) return;
  if (waiting) leaveOut(*waiting, "the frame after it gave no velocity", recording, decision);
  if (end == WindowEnd::kWaiting) return;
  last_given_ = window_.lastStamp();
  becauseOf(GuideReason::kNotSolved, frame, decision);
  leaveOut(frame.index, "the window with it has no solution", recording, decision);
}

void ImuStageTracker::leaveOut(int index, const std::string& why, ImuStageRecording& recording,
                               Decision& decision) {
  recording.drop(index);
  withdraw(index, why, decision);
}

namespace {

Failure notConverged() { return {FailureCode::kFirstFramesNotConverged}; }

}  // namespace

Result<CameraImuWindow> startImuWindow(const ImuStageRecording& recording,
                                       const std::vector<CameraCalibration>& cameras,
                                       const TrajectoryGuideOptions& options) {
  const Session session = recording.session();
  CameraImuOptions batch = recording.batchOptions();
  batch.noise_check = false;  // of no use to a start
  const auto result = calibrateCameraImu(session, cameras, batch);
  if (!result) return result.failure();
  if (!result->summary.converged) return notConverged();
  CameraImuProblem problem = makeProblem(session, batch);
  // Cameras' own stamps are of the batch: the window takes a frame's views as exposed together.
  problem.view_stamps.clear();
  CameraImuEstimate estimate = calibrationEstimate(*result);
  estimate.time_offsets.resize(1);
  std::vector<TimeNs> stamps;
  for (const Frame& frame : result->frames) stamps.push_back(frame.t);
  const auto selection =
      selectFrames(stamps, problem.samples, imuGaps(problem.samples, batch.max_gap_intervals),
                   selectionOptions(batch, estimate.timeOffset()));
  for (const int i : selection.chosen) {
    problem.frames.push_back(result->frames[static_cast<std::size_t>(i)]);
    estimate.states.push_back(result->states[static_cast<std::size_t>(i)]);
  }
  if (problem.frameCount() <= options.window) return notConverged();
  problem.links = selection.links;
  problem.weights.assign(problem.frames.size(), 1);
  CameraImuWindowOptions size;
  size.states = options.window;
  auto window = CameraImuWindow::fromBatch(problem, estimate, session.target, size);
  if (!window) return notConverged();
  return std::move(*window);
}

}  // namespace plumbline
