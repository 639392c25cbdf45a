// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/imu_stage_tracker.h"

#include <string>

#include <fmt/format.h>

#include "calibrator/batch/camera_imu/stage.h"

namespace plumbline {
namespace {

/// Of which frame a note speaks, unless it is the decision's own.
std::string prefix(const PosedFrame& frame, const Decision& decision) {
  return frame.t == decision.t ? "" : fmt::format("frame {}: ", frame.index);
}

/// A decision's reason is that of its own frame; what becomes of earlier ones is told by notes and
/// `withdrawn`.
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
  note(decision,
       prefix(frame, decision) + pause + ": linked only by the random walk of the biases");
  return FrameLink::kBiasWalk;
}

/// A frame that the window held back comes in with this one or not at all.
void ImuStageTracker::enter(const PosedFrame& frame, ImuStageRecording& recording,
                            Decision& decision) {
  const FrameLink link = linkTo(frame, recording, decision);
  last_given_ = frame.t;
  const WindowEnd end = window_.add({frame.t, frame.corners, frame.T_FC0, link});
  const std::optional<int> waiting = std::exchange(held_, std::nullopt);
  if (end == WindowEnd::kWaiting) {
    held_ = frame.index;
    note(decision, prefix(frame, decision) + "waits for the next frame to determine its velocity");
  }
  if (end == WindowEnd::kSolved) return;
  if (waiting) recording.drop(*waiting, "the frame after it gave no velocity", decision);
  if (end == WindowEnd::kWaiting) return;
  // The window is as it was before the frame: the next one links to its last.
  last_given_ = window_.lastStamp();
  becauseOf(GuideReason::kNotSolved, frame, decision);
  recording.drop(frame.index, "the window with it has no solution", decision);
}

Result<ImuWindowStart> startImuWindow(const ImuStageRecording& recording,
                                      const std::vector<CameraCalibration>& cameras,
                                      const TrajectoryGuideOptions& options) {
  const Failure not_converged{FailureCode::kFirstFramesNotConverged};
  const Session session = recording.session();
  CameraImuOptions batch = recording.batchOptions();
  batch.noise_check = false;  // of no use to a start
  const auto result = calibrateCameraImu(session, cameras, batch);
  if (!result) return result.failure();
  if (!result->summary.converged) return not_converged;
  auto [problem, estimate] = solvedBatch(session, *result, batch);
  // Cameras' own stamps are of the batch: the window takes a frame's views as exposed together.
  problem.view_stamps.clear();
  // The window has one offset: camera 0's.
  estimate.time_offsets.resize(1);
  // Without a frame that leaves there would be no prior to begin with.
  if (problem.frameCount() <= options.window) return not_converged;
  CameraImuWindowOptions size;
  size.states = options.window;
  auto window = CameraImuWindow::fromBatch(problem, estimate, session.target, size);
  if (!window) return not_converged;
  ImuWindowStart start{std::move(*window), {}};
  for (const Frame& frame : result->frames) start.stamps.push_back(frame.t);
  return start;
}

}  // namespace plumbline
