// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/base/error.h"
#include "calibrator/base/guide_decision.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/guidance/guide_options.h"
#include "calibrator/window/camera_imu_window.h"

namespace plumbline {

/// A frame whose corners gave a pose.
struct PosedFrame {
  int index = 0;  ///< position in the recording
  TimeNs t = 0;
  std::vector<std::vector<Corner>> corners;  ///< per camera; empty: too few
  Transform T_FC0;
  bool after_jump = false;  ///< the frames paused before it for too long
};

struct FramePoseOptions {
  int min_corners = 16;  ///< of one camera, for its view to count
  double max_rms_px = 30;

  /// Throws InputError for fewer than four corners (of one tag) or an error that is not positive.
  void check() const;
};

/// The frame with the views that show enough, and camera 0's pose by them alone. Empty where they
/// give none, or one that leaves more than max_rms_px.
std::optional<PosedFrame> poseFrame(const GuideFrame& frame, const AprilGrid& target,
                                    const std::vector<CameraCalibration>& cameras,
                                    const FramePoseOptions& options);

/// All that has arrived in the camera-IMU stage: IMU samples, and the frames kept.
class ImuStageRecording {
 public:
  ImuStageRecording(GuideRig rig, const GuideOptions& options);

  /// Takes the samples that are later than those before; the others are passed over.
  /// Returns how many were taken.
  int addSamples(std::span<const ImuSample> samples);
  void keep(PosedFrame frame) { frames_.push_back(std::move(frame)); }
  /// The frame of this position in the recording is not kept after all.
  void drop(int index);

  const std::vector<ImuSample>& samples() const { return samples_; }
  const std::vector<PosedFrame>& frames() const { return frames_; }

  /// Longest pause between samples that counts as none [s]: five times their median interval.
  double longestInterval() const;
  /// The longest pause between samples above that, in [from, to] of the IMU's clock [s].
  std::optional<double> gapWithin(TimeNs from, TimeNs to) const;
  /// Whether the samples reach this instant of the IMU's clock.
  bool covers(TimeNs t_imu) const { return !samples_.empty() && samples_.back().t >= t_imu; }
  double cameraRateHz() const;  ///< by the median interval between frames kept

  /// The kept frames and all samples.
  Session session() const;
  CameraImuOptions batchOptions() const;

 private:
  GuideRig rig_;
  GuideOptions options_;
  std::vector<ImuSample> samples_;
  std::vector<PosedFrame> frames_;
};

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
  /// A frame that was accepted leaves the estimate.
  void leaveOut(int index, const std::string& why, ImuStageRecording& recording,
                Decision& decision);
  void enter(const PosedFrame& frame, ImuStageRecording& recording, Decision& decision);

  CameraImuWindow window_;
  double max_gap_s_;
  TimeNs last_given_;        // stamp of the frame given to the window last
  std::optional<int> held_;  // position of the frame that the window holds back
  std::deque<PosedFrame> pending_;
};

/// The window on the first frames of the camera-IMU stage: their batch (the time offset by
/// correlation and refined in it, then fixed), of which all but the last frames become the window's
/// prior. Frames at the end that IMU samples do not cover yet are left out. Fails where
/// calibrateCameraImu() does or where it did not converge.
Result<CameraImuWindow> startImuWindow(const ImuStageRecording& recording,
                                       const std::vector<CameraCalibration>& cameras,
                                       const TrajectoryGuideOptions& options);

}  // namespace plumbline
