// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/guidance/imu_stage_recording.h"
#include "calibrator/window/camera_imu_window.h"

namespace plumbline {

/// The window of the camera-IMU stage and how frames come into it: one waits until IMU samples
/// reach it under the time offset, and is joined to the frame before by them or, across a pause of
/// the samples or of the frames, by the biases' walk alone. What became of a frame is written to
/// the decision of the frame that is at hand.
class ImuStageTracker {
 public:
  /// Frames further apart than `max_gap_s` are joined by the biases' walk alone.
  ImuStageTracker(CameraImuWindow window, double max_gap_s);

  const CameraImuWindow& window() const { return window_; }
  void addSamples(std::span<const ImuSample> samples) { window_.addSamples(samples); }
  void add(PosedFrame frame) { pending_.push_back(std::move(frame)); }
  /// Puts the frames that the recording's samples reach by now into the window. A frame without a
  /// solution is dropped from the recording.
  void drain(ImuStageRecording& recording, Decision& decision);

 private:
  FrameLink linkTo(const PosedFrame& frame, const ImuStageRecording& recording,
                   Decision& decision) const;
  void enter(const PosedFrame& frame, ImuStageRecording& recording, Decision& decision);

  CameraImuWindow window_;
  double max_gap_s_;
  TimeNs last_given_;        // stamp of the frame given to the window last
  std::optional<int> held_;  // position of the frame that the window holds back
  std::deque<PosedFrame> pending_;
};

/// A window, and the stamps of all frames in the batch that it began with, ascending.
struct ImuWindowStart {
  CameraImuWindow window;
  std::vector<TimeNs> stamps;
};

/// The window on the first frames of the camera-IMU stage: their batch (the time offset by
/// correlation and refined in it, then fixed), of which all but the last frames become the window's
/// prior. Frames at the end that IMU samples do not cover yet are left out, as are those that the
/// batch has no use for. Fails where calibrateCameraImu() does or where it did not converge.
Result<ImuWindowStart> startImuWindow(const ImuStageRecording& recording,
                                      const std::vector<CameraCalibration>& cameras,
                                      const TrajectoryGuideOptions& options);

}  // namespace plumbline
